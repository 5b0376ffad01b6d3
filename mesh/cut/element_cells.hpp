#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lancet/mesh/cut/cell.hpp"
#include "lancet/mesh/cut/facet.hpp"

namespace lancet::mesh {

/// A cell, which does not change, with its integrals once they have been asked for.
struct SharedCell {
    Cell shape;
    unsigned corners = 0;  ///< bit k: it holds corner k
    std::optional<PartMoments> moments{};
    /// A box around it, where the corners of its tetrahedron were last.
    struct Place {
        std::array<Point, 4> corners{};
        Facet::Box box{};
    };
    std::optional<Place> place{};
};

/// One tetrahedron divided by cuts: convex cells, and the parts that they form. Cells that share an open area belong to
/// one part; a facet that ends inside of the element may divide cells and yet separate nothing.
class ElementCells {
  public:
    using Facets = std::shared_ptr<const std::vector<Facet>>;

    ElementCells();

    /// Divides the cells of a part by those facets of a surface that are near (see facets_near), whose functions are
    /// taken at `corners`: the places of the corners at rest, or where the part has moved them. With `extends`, a facet
    /// that crosses a cell goes on behind its outer borders, to the faces of the element. Returns true where a facet
    /// crosses a cell or covers a face of one.
    bool divide(int part, const Facets& facets, std::span<const Facet* const> near, const std::array<Point, 4>& corners,
                bool extends);
    /// Numbers the parts anew, those of lower parts first. Returns the part that each one was in before.
    std::vector<int> regroup();

    int parts() const noexcept { return parts_; }
    PartMoments moments(int part) const;
    std::size_t cells() const noexcept { return cells_.size(); }
    const Cell& cell(std::size_t number) const { return cells_[number]->shape; }
    int part_of_cell(std::size_t cell) const { return part_of_cell_[cell]; }
    const PlanePool& pool() const noexcept { return pool_; }
    /// Facets in the plane of faces of cells.
    std::span<const Cover> covers() const noexcept { return covers_; }
    /// True where the plane is a facet's, which separates what lies on its two sides.
    bool is_cut(int plane) const { return plane_is_cut_[static_cast<std::size_t>(plane)]; }
    /// A piece of a facet in the element, and the parts on both of its sides, which may be one.
    struct Section {
        int plane = 0;
        int above = 0, below = 0;
        std::vector<Barycentric> corners{};
    };
    std::vector<Section> sections() const;

    /// Adds a plane by its values at the corners, for `halves`. Returns its number.
    int add_guide(const std::array<double, 4>& values);
    /// What a part has on either side of a plane of the pool, and the polygons between, in which the plane divides
    /// cells.
    struct Halves {
        PartMoments below{}, above{};
        std::vector<std::vector<Barycentric>> section{};
    };
    Halves halves(int part, int plane) const;

    /// The part in whose inside, or else on whose border, a place lies.
    int part_at(const Barycentric& place) const;
    /// True where the part holds the corner, on its border or inside.
    bool touches(int part, int corner) const;

  private:
    /// Two cells that meet in an open plane, one that separates nothing.
    struct Joint {
        int below = 0, above = 0;
        int plane = 0;
        bool is_known = false;  ///< they share an open area; else they may
    };
    class Division;
    int add_plane(const Plane& plane, const std::array<Point, 4>& corners, bool is_cut);
    std::shared_ptr<SharedCell> shared(Cell&& cell) const;
    void replace(std::size_t cell, Cell&& below, Cell&& above, std::vector<Cell>&& outside,
                 std::span<PointSides> planes);
    void replace_joints(std::size_t cell, std::size_t first_new, std::span<PointSides> planes);
    bool share_area(const Joint& joint);
    const PartMoments& moments_of_cell(std::size_t cell) const;

    PlanePool pool_;
    std::vector<bool> plane_is_cut_;
    std::vector<std::shared_ptr<SharedCell>> cells_;
    std::vector<int> part_of_cell_;
    std::vector<Joint> joints_;
    std::vector<Cover> covers_;
    std::vector<Facets> facets_;  ///< which the pool refers to
    int parts_ = 1;
};

}  // namespace lancet::mesh
