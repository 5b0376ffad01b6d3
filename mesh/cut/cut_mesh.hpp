#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "lancet/mesh/cut/cut_surface.hpp"
#include "lancet/mesh/cut/part_moments.hpp"
#include "lancet/mesh/face_neighbours.hpp"
#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh {

class ElementCells;

/// What becomes of an element in which a cut ends.
enum class FrontTreatment {
    retract,  ///< it stays whole: the cut ends at the faces behind
    extend    ///< it is cut right through: the cut ends at the faces ahead (Schoch 2013)
};

/// A point of the material: it stays with its part whatever is cut. Its place is sum_i weights[i] x(copy i of the
/// part).
struct MaterialPoint {
    std::int32_t part = 0;
    Barycentric weights{};
};

/// What a cut changed.
struct CutReport {
    std::int32_t touched_elements = 0;  ///< that a facet crosses or whose faces it covers
    std::int32_t divided_elements = 0;  ///< that have more parts than before
    std::int32_t new_parts = 0;
    std::int32_t new_copies = 0;
    std::vector<std::int32_t> elements{};  ///< that were touched, ascending
    double seconds_geometry = 0;           ///< clipping
    double seconds_topology = 0;           ///< parts and copies
};

/// A mesh with cuts: what is separated, and what still hangs together.
///
/// Each element is one part or several: its pieces that no cut connects. Parts of neighbouring elements hang together
/// where they share an area of their face that no cut covers. A node has one copy for each group of parts around it
/// that hang together; the value at a copy is what the parts of its group have at that node. A cut may touch what it
/// likes: it separates only what lies on both of its sides, and around its border everything hangs together.
///
/// Parts and copies keep their numbers when further cuts are made: a part that is divided keeps its largest piece, and
/// a copy the piece that holds the node; what is new is numbered behind. Part e is of element e, and copy n of node n,
/// for all elements and nodes of the mesh.
class CutMesh {
  public:
    explicit CutMesh(TetMesh mesh);

    /// Cuts along a surface, given at rest or, with `positions` of all copies, where they are now. The work is
    /// proportional to the number of elements near the surface, but for one look at the places of all nodes.
    /// Throws lancet::Error where the positions are not as many as copies, or a coordinate or the value of a level set
    /// is not finite; nothing is cut then.
    CutReport cut(const CutSurface& surface, FrontTreatment front = FrontTreatment::retract,
                  std::span<const Point> positions = {});

    const TetMesh& mesh() const noexcept { return *mesh_; }

    /// The copies at the corners of each part.
    std::span<const Tetrahedron> parts() const noexcept { return parts_; }
    std::span<const std::int32_t> element_of_part() const noexcept { return element_of_part_; }
    /// The part that each was cut from; -1 for the first of an element.
    std::span<const std::int32_t> parent_of_part() const noexcept { return parent_of_part_; }
    PartMoments moments(std::int32_t part) const;

    /// The node of each copy.
    std::span<const std::int32_t> node_of_copy() const noexcept { return node_of_copy_; }
    /// The copy that each was separated from; -1 for the first of a node.
    std::span<const std::int32_t> parent_of_copy() const noexcept { return parent_of_copy_; }
    std::vector<std::int32_t> copies_of_node(std::int32_t node) const;
    std::vector<std::int32_t> parts_of_element(std::int32_t element) const;
    /// The elements around a node of the mesh.
    std::span<const std::int32_t> star(std::int32_t node) const { return base_->stars.of(node); }
    /// The nodes' places at rest, for each copy.
    std::vector<Point> rest_positions() const;

    /// The part in which a place of an element lies; where it lies on a cut, one of those beside.
    MaterialPoint material_point(std::int32_t element, const Barycentric& place) const;

    /// What is behind the face of a part that is opposite a corner.
    enum class FaceState {
        joined,  ///< a part of the neighbour that it hangs together with
        opened,  ///< nothing, since a cut runs along the face
        outer    ///< nothing: it is of the body's own surface
    };
    FaceState face_state(std::int32_t part, int corner) const;

    /// The elements that cuts touch, ascending.
    std::vector<std::int32_t> touched_elements() const;
    /// The cells of an element that cuts touch, or nothing.
    const ElementCells* cells(std::int32_t element) const;

  private:
    using PartPairs = std::vector<std::pair<std::int32_t, std::int32_t>>;
    struct CutElement {
        std::int32_t element = 0;
        std::shared_ptr<const ElementCells> cells;
        std::vector<std::int32_t> parts;  ///< numbers of its parts in all
        std::vector<PartMoments> moments;
    };
    struct Base {
        std::vector<std::array<std::int32_t, 4>> neighbours;
        NodeStars stars;
    };

    struct Change;
    void require_finite(const CutSurface& surface, std::span<const Point> positions) const;
    std::vector<std::int32_t> elements_near(const CutSurface& surface, std::span<const Point> positions) const;
    void divide(std::int32_t element, const CutSurface& surface, FrontTreatment front, std::span<const Point> positions,
                Change& change);
    void join_faces(std::int32_t element, Change& change) const;
    void regroup_copies(std::int32_t node);
    std::array<Point, 4> corners_of(std::int32_t part, std::span<const Point> positions) const;
    std::span<const std::int32_t> parts_in(std::int32_t element) const;
    const CutElement* cut_element(std::int32_t element) const {
        const std::int32_t place = place_[static_cast<std::size_t>(element)];
        return place < 0 ? nullptr : &cut_elements_[static_cast<std::size_t>(place)];
    }
    std::int64_t face_of(std::int32_t element, int corner) const;
    int corner_towards(std::int32_t element, std::int32_t neighbour) const;

    std::shared_ptr<const TetMesh> mesh_;
    std::shared_ptr<const Base> base_;
    std::vector<Tetrahedron> parts_;
    std::vector<std::int32_t> element_of_part_, parent_of_part_;
    std::vector<std::int32_t> node_of_copy_, parent_of_copy_;
    std::vector<std::int32_t> place_;  ///< [element] among the cut ones; -1: no cut touches it
    std::vector<CutElement> cut_elements_;
    /// Of faces whose elements cuts divide, by face_of; elsewhere the only parts are joined.
    std::unordered_map<std::int64_t, PartPairs> joints_;
    std::map<std::int32_t, std::vector<std::int32_t>> further_copies_;  ///< of nodes that have more than one
};

}  // namespace lancet::mesh
