#include "lancet/runtime/cut/divided_elements.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "lancet/mesh/cut/element_lanes.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"

namespace lancet::runtime {

namespace {

using Pieces = std::map<std::int32_t, std::vector<mesh::FrontOpening::Piece>>;

const std::vector<mesh::FrontOpening::Piece>* of(const Pieces& pieces, std::int32_t element) {
    const auto found = pieces.find(element);
    return found == pieces.end() ? nullptr : &found->second;
}

void sort_unique(std::vector<std::int32_t>& numbers) {
    std::ranges::sort(numbers);
    numbers.erase(std::ranges::unique(numbers).begin(), numbers.end());
}

bool is_whole(const std::vector<DividedElements::Lane>& lanes) {
    return lanes.size() == 1 && lanes.front().moments.fraction == 1 &&
           std::ranges::none_of(lanes.front().copies, is_opening);
}

}  // namespace

DividedElements::DividedElements(const mesh::CutMesh& cut, mesh::Fronts fronts)
    : fronts_(fronts),
      place_(cut.mesh().tetrahedra().size(), -1),
      next_number_(static_cast<std::int32_t>(place_.size())) {
    Pieces pieces;
    if (fronts == mesh::Fronts::blended) {
        const mesh::FrontOpening front(cut);
        opened_from_ = front.opened_from();
        pieces = front.pieces();
    }
    std::vector<std::int32_t> divided = cut.touched_elements();
    for (const auto& [element, list] : pieces) near_fronts_.push_back(element);
    divided.insert(divided.end(), near_fronts_.begin(), near_fronts_.end());
    sort_unique(divided);
    for (const std::int32_t element : divided) {
        std::vector<Lane> lanes = taken(lanes_of_element(cut, element, of(pieces, element)), cut);
        lanes.front().number = element;
        for (std::size_t k = 1; k < lanes.size(); ++k) lanes[k].number = next_number_++;
        keep(element, std::move(lanes));
    }
}

/// With names for copies, and moments that can be computed with.
std::vector<DividedElements::Lane> DividedElements::taken(std::vector<mesh::Lanes::Lane> lanes,
                                                          const mesh::CutMesh& cut) const {
    const auto copies = static_cast<std::int32_t>(cut.node_of_copy().size());
    std::vector<Lane> taken;
    for (const mesh::Lanes::Lane& lane : lanes) {
        Lane& added = taken.emplace_back(-1, lane.copies, at_least_smallest(lane.moments));
        for (CopyName& name : added.copies) {
            if (name >= copies) name = opening_from(opened_from_[static_cast<std::size_t>(name - copies)]);
        }
    }
    return taken;
}

void DividedElements::keep(std::int32_t element, std::vector<Lane> lanes) {
    std::int32_t& place = place_[static_cast<std::size_t>(element)];
    if (place >= 0) {
        lanes_[static_cast<std::size_t>(place)] = std::move(lanes);
    } else if (!is_whole(lanes) || lanes.front().number != element) {
        place = static_cast<std::int32_t>(lanes_.size());
        lanes_.push_back(std::move(lanes));
    }
}

std::int32_t DividedElements::node_of(const mesh::CutMesh& cut, CopyName name) const {
    if (!is_opening(name)) return name;
    const auto found = std::ranges::lower_bound(opened_from_, opening_from(name));
    if (found == opened_from_.end() || *found != opening_from(name)) return -1;
    return static_cast<std::int32_t>(static_cast<std::ptrdiff_t>(cut.node_of_copy().size()) +
                                     (found - opened_from_.begin()));
}

std::vector<DividedElements::Change> DividedElements::update(const mesh::CutMesh& cut,
                                                             std::span<const std::int32_t> elements,
                                                             std::int32_t copies_before) {
    changed_.assign(elements.begin(), elements.end());
    changed_copies_.clear();
    const auto copies = static_cast<std::int32_t>(cut.node_of_copy().size());
    for (std::int32_t copy = copies_before; copy < copies; ++copy) {
        const auto star = cut.star(cut.node_of_copy()[static_cast<std::size_t>(copy)]);
        changed_.insert(changed_.end(), star.begin(), star.end());
    }
    Pieces pieces;
    if (fronts_ == mesh::Fronts::blended) {
        changed_.insert(changed_.end(), near_fronts_.begin(), near_fronts_.end());
        const mesh::FrontOpening front(cut);
        opened_from_ = front.opened_from();
        pieces = front.pieces();
        near_fronts_.clear();
        for (const auto& [element, list] : pieces) near_fronts_.push_back(element);
        changed_.insert(changed_.end(), near_fronts_.begin(), near_fronts_.end());
    }
    sort_unique(changed_);

    std::vector<Change> changes;
    for (const std::int32_t element : changed_) {
        std::vector<Lane> before;
        for_each_lane(cut, element, [&](const Lane& lane) { before.push_back(lane); });
        if (place_[static_cast<std::size_t>(element)] < 0) {
            // The mesh has its copies as they are now: go back to those that they were.
            for (CopyName& copy : before.front().copies) {
                while (copy >= copies_before) copy = cut.parent_of_copy()[static_cast<std::size_t>(copy)];
            }
        }
        replace(element, std::move(before), taken(lanes_of_element(cut, element, of(pieces, element)), cut), changes);
    }
    sort_unique(changed_copies_);
    return changes;
}

/// Lanes with the same copies keep their numbers, and so do others as far as there are some.
void DividedElements::replace(std::int32_t element, std::vector<Lane> before, std::vector<Lane> after,
                              std::vector<Change>& changes) {
    const std::int32_t like = before.front().number;
    const auto add = [&](const Lane& lane, bool is_there, std::int32_t of_new) {
        changes.push_back({element, is_there, lane, of_new});
    };
    const auto add_copies = [&](const Lane& lane) {
        changed_copies_.insert(changed_copies_.end(), lane.copies.begin(), lane.copies.end());
    };
    for (Lane& lane : after) {
        const auto same =
            std::ranges::find_if(before, [&](const Lane& old) { return old.number >= 0 && old.copies == lane.copies; });
        if (same == before.end()) continue;
        lane.number = std::exchange(same->number, -1);
        if (same->moments == lane.moments) continue;
        add(lane, true, -1);
        add_copies(lane);
    }
    auto left = before.begin();
    const auto next_left = [&] {
        left = std::find_if(left, before.end(), [](const Lane& old) { return old.number >= 0; });
        return left != before.end();
    };
    for (Lane& lane : after) {
        if (lane.number >= 0) continue;
        add_copies(lane);
        if (next_left()) {
            add_copies(*left);
            lane.number = std::exchange(left->number, -1);
            add(lane, true, -1);
            continue;
        }
        if (free_numbers_.empty()) {
            lane.number = next_number_++;
        } else {
            lane.number = free_numbers_.back();
            free_numbers_.pop_back();
        }
        add(lane, true, like);
    }
    std::vector<std::int32_t> gone;
    while (next_left()) {
        add_copies(*left);
        add(*left, false, -1);
        gone.push_back(std::exchange(left->number, -1));
    }
    free_numbers_.insert(free_numbers_.end(), gone.begin(), gone.end());
    keep(element, std::move(after));
}

}  // namespace lancet::runtime
