#include "lancet/mesh/cut/lanes.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/cut/element_lanes.hpp"

namespace lancet::mesh {

namespace {

/// Collects the lanes of one element; equal ones are added up.
class ElementLanes {
  public:
    explicit ElementLanes(std::int32_t element) : element_(element) {}

    void add(const Tetrahedron& copies, const PartMoments& moments, double weight = 1) {
        const auto same = std::ranges::find_if(lanes_, [&](const Lanes::Lane& lane) { return lane.copies == copies; });
        Lanes::Lane& lane = same != lanes_.end() ? *same : lanes_.emplace_back(element_, copies, empty_moments());
        add_weighted(lane.moments, moments, weight);
    }

    std::vector<Lanes::Lane> take() {
        // One lane that has everything is whole, whatever the rounding of its pieces.
        if (lanes_.size() == 1) lanes_.front().moments = PartMoments{};
        return std::move(lanes_);
    }

  private:
    std::int32_t element_;
    std::vector<Lanes::Lane> lanes_;
};

}  // namespace

std::string_view to_string(Fronts fronts) noexcept {
    return fronts == Fronts::blended ? "blended" : "sharp";
}

std::vector<Lanes::Lane> lanes_of_element(const CutMesh& cut, std::int32_t element,
                                          const std::vector<FrontOpening::Piece>* pieces) {
    if (pieces == nullptr && cut.cells(element) == nullptr) {
        return {{element, cut.parts()[static_cast<std::size_t>(element)], PartMoments{}}};
    }
    ElementLanes lanes(element);
    if (pieces != nullptr) {
        for (const FrontOpening::Piece& piece : *pieces) lanes.add(piece.copies, piece.moments, piece.weight);
    } else {
        for (const std::int32_t part : cut.parts_of_element(element)) {
            lanes.add(cut.parts()[static_cast<std::size_t>(part)], cut.moments(part));
        }
    }
    return lanes.take();
}

Lanes lanes(const CutMesh& cut, Fronts fronts) {
    Lanes result;
    result.node_of_copy.assign(cut.node_of_copy().begin(), cut.node_of_copy().end());
    std::map<std::int32_t, std::vector<FrontOpening::Piece>> opening;
    if (fronts == Fronts::blended) {
        FrontOpening front(cut);
        result.opened_from = front.opened_from();
        for (const std::int32_t copy : result.opened_from) {
            result.node_of_copy.push_back(cut.node_of_copy()[static_cast<std::size_t>(copy)]);
        }
        opening = front.pieces();
    }
    const std::size_t elements = cut.mesh().tetrahedra().size();
    std::vector<Lanes::Lane> further;
    for (std::size_t e = 0; e < elements; ++e) {
        const auto element = static_cast<std::int32_t>(e);
        const auto pieces = opening.find(element);
        std::vector<Lanes::Lane> list =
            lanes_of_element(cut, element, pieces == opening.end() ? nullptr : &pieces->second);
        result.lanes.push_back(list.front());
        further.insert(further.end(), list.begin() + 1, list.end());
    }
    result.lanes.insert(result.lanes.end(), further.begin(), further.end());
    return result;
}

void raise_fractions(Lanes& lanes, double floor) {
    if (!(floor >= 0 && floor < 1)) throw Error("cuts: the smallest fraction of an element must be in [0, 1)");
    for (Lanes::Lane& lane : lanes.lanes) {
        const double fraction = lane.moments.fraction;
        if (fraction >= floor) continue;
        // What is too thin to have a centre gets that of the whole element.
        const bool has_centre = fraction >= std::numeric_limits<double>::min();
        const PartMoments own = has_centre ? lane.moments : PartMoments{};
        lane.moments = empty_moments();
        add_weighted(lane.moments, own, floor / own.fraction);
        lane.moments.fraction = floor;
    }
}

}  // namespace lancet::mesh
