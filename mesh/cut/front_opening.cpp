#include "lancet/mesh/cut/front_opening.hpp"

#include <algorithm>
#include <cmath>

namespace lancet::mesh {

namespace {

int sign_of(double value) {
    return value < 0 ? -1 : 1;
}

}  // namespace

FrontOpening::FrontOpening(const CutMesh& cut) : cut_(cut) {
    find_fronts();
    std::set<std::int32_t> around;
    for (const auto& [copy, front] : fronts_) {
        for (const std::int32_t element : cut_.star(cut_.node_of_copy()[static_cast<std::size_t>(copy)])) {
            around.insert(element);
        }
    }
    for (const std::int32_t element : around) divide_region(element);
    close_undivided();
    for (auto& [copy, front] : fronts_) {
        if (front.openness() == 0) continue;
        front.far = static_cast<std::int32_t>(cut_.node_of_copy().size() + opened_from_.size());
        opened_from_.push_back(copy);
    }
}

/// int lambda_k over a polygon of an element, at rest.
std::array<double, 4> FrontOpening::section_moments(std::int32_t element, std::span<const Barycentric> polygon) const {
    const auto nodes = cut_.mesh().nodes();
    const Tetrahedron& t = cut_.mesh().tetrahedra()[static_cast<std::size_t>(element)];
    const auto at = [&](const Barycentric& b) {
        Point x{};
        for (std::size_t k = 0; k < 4; ++k) {
            for (std::size_t axis = 0; axis < 3; ++axis) x[axis] += b[k] * nodes[t[k]][axis];
        }
        return x;
    };
    std::array<double, 4> moments{};
    for (std::size_t k = 2; k < polygon.size(); ++k) {
        const double third = area(at(polygon[0]), at(polygon[k - 1]), at(polygon[k])) / 3;
        for (std::size_t i = 0; i < 4; ++i) {
            moments[i] += third * (polygon[0][i] + polygon[k - 1][i] + polygon[k][i]);
        }
    }
    return moments;
}

void FrontOpening::find_fronts() {
    std::map<std::int32_t, double> nearest;  // copy -> the largest share of a cut so far
    for (const std::int32_t element : cut_.touched_elements()) {
        const ElementCells& cells = *cut_.cells(element);
        const std::vector<std::int32_t> parts = cut_.parts_of_element(element);
        double largest = 0;
        for (const ElementCells::Section& section : cells.sections()) {
            const std::array<double, 4> moments = section_moments(element, section.corners);
            const auto copies_of = [&](int part) {
                return cut_.parts()[static_cast<std::size_t>(parts[static_cast<std::size_t>(part)])];
            };
            const Tetrahedron above = copies_of(section.above), below = copies_of(section.below);
            const Guide guide{element, cells.pool().values(section.plane)};
            for (std::size_t k = 0; k < 4; ++k) {
                if (above[k] != below[k]) continue;
                Front& front = fronts_[above[k]];
                front.cut += moments[k];
                if (moments[k] > nearest[above[k]]) {
                    nearest[above[k]] = moments[k];
                    front.guide = guide;
                }
                if (moments[k] <= largest) continue;
                largest = moments[k];
                own_guides_[element] = guide;
                own_planes_[element] = section.plane;
            }
        }
    }
}

/// The guide as a function on another element: affine at rest.
FrontOpening::Guide FrontOpening::carried(const Guide& guide, std::int32_t element) const {
    if (guide.element == element) return guide;
    Guide carried{element, {}};
    const Tetrahedron &from = cut_.mesh().tetrahedra()[static_cast<std::size_t>(guide.element)],
                      &to = cut_.mesh().tetrahedra()[static_cast<std::size_t>(element)];
    for (std::size_t k = 0; k < 4; ++k) {
        const auto shared = std::ranges::find(from, to[k]);
        if (shared != from.end()) {
            carried.values[k] = guide.values[static_cast<std::size_t>(shared - from.begin())];
            continue;
        }
        const auto nodes = cut_.mesh().nodes();
        const Barycentric weights =
            barycentric({nodes[from[0]], nodes[from[1]], nodes[from[2]], nodes[from[3]]}, nodes[to[k]]);
        for (std::size_t i = 0; i < 4; ++i) carried.values[k] += weights[i] * guide.values[i];
    }
    return carried;
}

/// The plane with which an element is divided: its own cut's, or that of the front with most of the element's corners.
FrontOpening::Guide FrontOpening::guide_of(std::int32_t element) const {
    if (const auto own = own_guides_.find(element); own != own_guides_.end()) return own->second;
    const Guide* best = nullptr;
    std::size_t most = 0;
    for (const std::int32_t part : cut_.parts_of_element(element)) {
        for (const std::int32_t copy : cut_.parts()[static_cast<std::size_t>(part)]) {
            const auto front = fronts_.find(copy);
            if (front == fronts_.end() || front->second.cut == 0) continue;
            const Tetrahedron &a = cut_.mesh().tetrahedra()[static_cast<std::size_t>(front->second.guide.element)],
                              &b = cut_.mesh().tetrahedra()[static_cast<std::size_t>(element)];
            const auto shared = static_cast<std::size_t>(
                std::ranges::count_if(a, [&](auto node) { return std::ranges::find(b, node) != b.end(); }));
            if (shared <= most) continue;
            most = shared;
            best = &front->second.guide;
        }
    }
    return best == nullptr ? Guide{} : carried(*best, element);
}

void FrontOpening::divide_region(std::int32_t element) {
    Region region{.guide = guide_of(element)};
    if (region.guide.element < 0) return;
    const ElementCells* known = cut_.cells(element);
    ElementCells cells = known == nullptr ? ElementCells() : *known;
    const auto own = own_planes_.find(element);
    const int plane = own != own_planes_.end() ? own->second : cells.add_guide(region.guide.values);
    const std::vector<std::int32_t> parts = cut_.parts_of_element(element);
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const ElementCells::Halves halves = cells.halves(static_cast<int>(p), plane);
        if (halves.below.fraction > 0) region.sides.push_back({parts[p], halves.below, -1});
        if (halves.above.fraction > 0) region.sides.push_back({parts[p], halves.above, 1});
        if (!(halves.below.fraction + halves.above.fraction >
              0)) {  // too thin for a number, and yet all of some copies
            region.sides.push_back({parts[p], cut_.moments(parts[p]), 0});
        }
        for (const std::vector<Barycentric>& polygon : halves.section) {
            const std::array<double, 4> moments = section_moments(element, polygon);
            for (std::size_t k = 0; k < 4; ++k) {
                const auto front = fronts_.find(cut_.parts()[static_cast<std::size_t>(parts[p])][k]);
                if (front != fronts_.end()) front->second.left += moments[k];
            }
        }
    }
    regions_[element] = std::move(region);
}

PartOpening FrontOpening::opening_of(std::int32_t part, const Region& region) const {
    PartOpening opening{.guide = region.guide.values, .corners = {}};
    for (std::size_t k = 0; k < 4; ++k) {
        const std::int32_t copy = cut_.parts()[static_cast<std::size_t>(part)][k];
        const auto found = fronts_.find(copy);
        if (found == fronts_.end() || found->second.openness() == 0) continue;
        const Front& front = found->second;
        const Guide here = carried(front.guide, region.guide.element);
        // Facets may be turned either way: sides are told as the front's guide has them.
        double agreement = 0;
        for (std::size_t i = 0; i < 4; ++i) agreement += here.values[i] * region.guide.values[i];
        opening.corners[k] = {front.openness(), sign_of(here.values[k]) * sign_of(agreement), front.far};
    }
    return opening;
}

std::map<std::int32_t, PartOpening> FrontOpening::openings() const {
    std::map<std::int32_t, PartOpening> openings;
    for (const auto& [element, region] : regions_) {
        for (const std::int32_t part : cut_.parts_of_element(element)) {
            const PartOpening opening = opening_of(part, region);
            if (opening.is_open()) openings[part] = opening;
        }
    }
    return openings;
}

/// A copy that has parts on one side of its cut alone, where other cuts have taken those of the other, stays closed:
/// its two sides would be one of them and nothing.
void FrontOpening::close_undivided() {
    std::map<std::int32_t, std::array<bool, 2>> has;  // by copy: parts on its own side, and on the far one
    for (const auto& [element, region] : regions_) {
        std::map<std::int32_t, PartOpening> openings;
        for (const Side& side : region.sides) {
            const auto [opening, is_new] = openings.try_emplace(side.part);
            if (is_new) opening->second = opening_of(side.part, region);
            for (std::size_t k = 0; k < 4; ++k) {
                const PartOpening::Corner& corner = opening->second.corners[k];
                if (corner.openness == 0 || side.side == 0) continue;
                has[cut_.parts()[static_cast<std::size_t>(side.part)][k]][side.side == corner.near_side ? 0 : 1] = true;
            }
        }
    }
    for (auto& [copy, front] : fronts_) {
        if (!has[copy][0] || !has[copy][1]) front.cut = 0;
    }
}

std::vector<FrontOpening::Piece> FrontOpening::pieces_of(std::int32_t element, const Region& region) const {
    std::map<std::int32_t, PartOpening> openings;
    std::set<double> levels{1.0};
    for (const std::int32_t part : cut_.parts_of_element(element)) {
        openings[part] = opening_of(part, region);
        for (const PartOpening::Corner& corner : openings[part].corners) {
            if (corner.openness > 0) levels.insert(corner.openness);
        }
    }
    std::vector<Piece> pieces;
    double lower = 0;
    for (const double level : levels) {
        // Thresholds in (lower, level): open is what is at least this far open.
        for (const Side& side : region.sides) {
            Tetrahedron copies = cut_.parts()[static_cast<std::size_t>(side.part)];
            const auto& corners = openings.at(side.part).corners;
            for (std::size_t k = 0; k < 4; ++k) {
                const bool is_far = side.side != 0 && side.side != corners[k].near_side;
                if (is_far && corners[k].openness >= level) copies[k] = corners[k].far;
            }
            pieces.push_back({copies, side.moments, level - lower});
        }
        lower = level;
    }
    return pieces;
}

std::map<std::int32_t, std::vector<FrontOpening::Piece>> FrontOpening::pieces() const {
    std::map<std::int32_t, std::vector<Piece>> pieces;
    for (const auto& [element, region] : regions_) pieces[element] = pieces_of(element, region);
    return pieces;
}

}  // namespace lancet::mesh
