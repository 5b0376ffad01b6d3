#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "lancet/runtime/cut/crumbs.hpp"
#include "lancet/runtime/cut/divided_elements.hpp"

namespace lancet::runtime {

/// The components of a body with cuts, kept while it is cut. A cut only takes apart: whatever comes off has a node next
/// to what has been cut, so all these nodes are followed at once, each front as far as the others, until those of a
/// component have met but for one, or have nothing left to go to. What that takes is proportional to the pieces that
/// come off, the largest left out, and where nothing does, to the way around the cut's end. With blended fronts what
/// opens may close again, and pieces that were apart hang together: components are then found anew.
class DividedComponents {
  public:
    /// - is_held: [node of the mesh] fixed, or prescribed in any component
    DividedComponents(const mesh::CutMesh& cut, const DividedElements& elements, std::vector<bool> is_held);

    /// Takes up a cut after `elements` has.
    void update(const mesh::CutMesh& cut, const DividedElements& elements);

    /// [node of the body] the component that it is of. Numbers are kept as long as nothing comes off and no blended
    /// front is there.
    std::vector<std::int32_t> of_nodes() const;

    /// As runtime::crumbs finds them in the divided scene.
    std::vector<Crumb> crumbs(const mesh::CutMesh& cut, const DividedElements& elements, double largest) const;

  private:
    struct Component {
        CopyName first = -1;    ///< its lowest node
        std::int64_t held = 0;  ///< copies of held nodes
        double volume = 0;      ///< cubic metres
    };
    /// What lies around a node.
    class Fronts;
    struct Piece {
        std::vector<CopyName> names;
        double volume = 0;
    };
    Piece piece_of(const mesh::CutMesh& cut, const DividedElements& elements, std::vector<CopyName> names) const;
    void take_off(const mesh::CutMesh& cut, const Piece& piece);

    std::vector<bool> is_held_;
    double whole_ = 0;                            ///< volume of the body
    std::vector<std::int32_t> label_;             ///< [copy] its component
    std::vector<std::int32_t> label_of_opening_;  ///< [node that opens] likewise
    bool has_openings_ = false;
    std::vector<Component> components_;
};

}  // namespace lancet::runtime
