#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lancet/mesh/cut/lanes.hpp"

namespace lancet::runtime {

/// A node of a body with cuts, by a number that it keeps: copy c of the cut mesh has c, and the copy that opens from it
/// at a blended front opening_from(c), which is its own inverse.
using CopyName = std::int32_t;
constexpr CopyName opening_from(CopyName name) noexcept {
    return ~name;
}
constexpr bool is_opening(CopyName name) noexcept {
    return name < 0;
}

/// The lanes of a cut mesh (lanes.hpp), as the elements of a body that changes with it: each has a number that it keeps
/// as long as it is there. Starts as mesh::lanes numbers them.
class DividedElements {
  public:
    struct Lane {
        std::int32_t number = 0;
        mesh::Tetrahedron copies{};  ///< names
        mesh::PartMoments moments{};
    };
    /// A lane that has come, gone, or is another now.
    struct Change {
        std::int32_t element = 0;  ///< of the mesh
        bool is_there = true;
        Lane lane{};
        std::int32_t like = -1;  ///< for one that has come: a lane of its element that was there before
    };

    DividedElements(const mesh::CutMesh& cut, mesh::Fronts fronts);

    /// Takes up a cut. `elements` are those that it touched, `copies_before` how many there were. The work is
    /// proportional to the elements around what is new; with blended fronts, to all around fronts and what is cut.
    std::vector<Change> update(const mesh::CutMesh& cut, std::span<const std::int32_t> elements,
                               std::int32_t copies_before);

    /// The elements whose lanes the last update looked at, ascending.
    std::span<const std::int32_t> changed_elements() const noexcept { return changed_; }
    /// The names of all nodes of lanes that the last update changed, as they were and as they are, ascending.
    std::span<const CopyName> changed_copies() const noexcept { return changed_copies_; }
    /// As in mesh::Lanes: the copies from which the last nodes of the body open, ascending.
    const std::vector<std::int32_t>& opened_from() const noexcept { return opened_from_; }
    /// The number of a node in the body (lanes.hpp); -1 where it is not there.
    std::int32_t node_of(const mesh::CutMesh& cut, CopyName name) const;

    /// Calls visit(lane) for the lanes of an element.
    template <class Visit>
    void for_each_lane(const mesh::CutMesh& cut, std::int32_t element, const Visit& visit) const {
        const std::int32_t place = place_[static_cast<std::size_t>(element)];
        if (place < 0) {
            visit(Lane{element, cut.parts()[static_cast<std::size_t>(element)], {}});
        } else {
            for (const Lane& lane : lanes_[static_cast<std::size_t>(place)]) visit(lane);
        }
    }

  private:
    std::vector<Lane> taken(std::vector<mesh::Lanes::Lane> lanes, const mesh::CutMesh& cut) const;
    void replace(std::int32_t element, std::vector<Lane> before, std::vector<Lane> after, std::vector<Change>& changes);
    void keep(std::int32_t element, std::vector<Lane> lanes);

    mesh::Fronts fronts_;
    std::vector<std::int32_t> place_;       ///< [element] in lanes_, -1 where it is whole and one
    std::vector<std::vector<Lane>> lanes_;  ///< of elements that a cut touches or a front is near
    std::vector<std::int32_t> opened_from_;
    std::vector<std::int32_t> near_fronts_;  ///< the elements that blended fronts divide, ascending
    std::vector<std::int32_t> free_numbers_;
    std::int32_t next_number_ = 0;
    std::vector<std::int32_t> changed_;
    std::vector<CopyName> changed_copies_;
};

}  // namespace lancet::runtime
