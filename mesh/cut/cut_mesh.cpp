#include "lancet/mesh/cut/cut_mesh.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <string>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/cut/element_cells.hpp"
#include "lancet/mesh/cut/face_joints.hpp"
#include "lancet/mesh/cut/facet.hpp"

namespace lancet::mesh {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

std::int32_t find(std::vector<std::int32_t>& group, std::int32_t member) {
    while (group[member] != member) member = group[member] = group[group[member]];
    return member;
}

void unite(std::vector<std::int32_t>& group, std::int32_t a, std::int32_t b) {
    a = find(group, a);
    b = find(group, b);
    group[std::max(a, b)] = std::min(a, b);
}

void sort_unique(std::vector<std::int32_t>& numbers) {
    std::ranges::sort(numbers);
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

/// The sides of a box beyond which a place lies: a tetrahedron's box and this one have no place in common where all its
/// corners lie beyond one of them.
unsigned sides_beyond(const Facet::Box& box, const Point& place) {
    unsigned sides = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        sides |= (place[axis] < box[0][axis] ? 1U : 0U) << (2 * axis);
        sides |= (place[axis] > box[1][axis] ? 2U : 0U) << (2 * axis);
    }
    return sides;
}

}  // namespace

/// What a cut has done so far.
struct CutMesh::Change {
    std::vector<std::int32_t> touched{};  ///< elements, ascending
    std::vector<std::int32_t> opened{};   ///< those of them that have new parts, or something new along a face
    std::map<std::int32_t, std::int32_t> before{};  ///< part -> the part that it was, where that is another
    std::map<std::int64_t, PartPairs> joints{};     ///< of faces, as they are now
    CutReport report{};

    std::int32_t part_before(std::int32_t part) const {
        const auto found = before.find(part);
        return found == before.end() ? part : found->second;
    }
};

CutMesh::CutMesh(TetMesh mesh) : mesh_(std::make_shared<const TetMesh>(std::move(mesh))) {
    base_ = std::make_shared<const Base>(Base{face_neighbours(*mesh_), node_stars(*mesh_)});
    parts_.assign(mesh_->tetrahedra().begin(), mesh_->tetrahedra().end());
    element_of_part_.resize(parts_.size());
    std::iota(element_of_part_.begin(), element_of_part_.end(), 0);
    parent_of_part_.assign(parts_.size(), -1);
    place_.assign(parts_.size(), -1);
    node_of_copy_.resize(mesh_->nodes().size());
    std::iota(node_of_copy_.begin(), node_of_copy_.end(), 0);
    parent_of_copy_.assign(node_of_copy_.size(), -1);
}

CutReport CutMesh::cut(const CutSurface& surface, FrontTreatment front, std::span<const Point> positions) {
    if (!positions.empty() && positions.size() != node_of_copy_.size()) {
        throw Error("cut: " + std::to_string(positions.size()) + " positions given; the mesh has " +
                    std::to_string(node_of_copy_.size()) + " copies of nodes");
    }
    require_finite(surface, positions);
    Change change;
    const auto start = Clock::now();
    const auto parts_before = parts_.size(), copies_before = node_of_copy_.size();
    for (const std::int32_t element : elements_near(surface, positions)) {
        divide(element, surface, front, positions, change);
    }
    change.report.seconds_geometry = seconds_since(start);

    // Where a cut has neither divided an element nor run along its faces, everything hangs together as it did.
    const auto start_topology = Clock::now();
    for (const std::int32_t element : change.opened) join_faces(element, change);
    for (auto& [face, pairs] : change.joints) joints_[face] = std::move(pairs);
    std::vector<std::int32_t> nodes;
    for (const std::int32_t element : change.opened) {
        const Tetrahedron& corners = mesh_->tetrahedra()[static_cast<std::size_t>(element)];
        nodes.insert(nodes.end(), corners.begin(), corners.end());
    }
    sort_unique(nodes);
    for (const std::int32_t node : nodes) regroup_copies(node);
    change.report.seconds_topology = seconds_since(start_topology);

    change.report.elements = std::move(change.touched);
    change.report.touched_elements = static_cast<std::int32_t>(change.report.elements.size());
    change.report.new_parts = static_cast<std::int32_t>(parts_.size() - parts_before);
    change.report.new_copies = static_cast<std::int32_t>(node_of_copy_.size() - copies_before);
    return change.report;
}

void CutMesh::require_finite(const CutSurface& surface, std::span<const Point> positions) const {
    for (std::size_t copy = 0; copy < positions.size(); ++copy) {
        for (const double value : positions[copy]) {
            if (!std::isfinite(value)) {
                throw Error("cut: the position of copy " + std::to_string(copy) + " is not finite");
            }
        }
    }
    // Planes are finite where the makers of surfaces let them pass; a function is anybody's.
    for (const Facet& facet : surface.facets()) {
        if (!facet.plane.is_function()) continue;
        for (const Point& place : positions.empty() ? mesh_->nodes() : positions) (void)facet.plane.value(place);
    }
}

std::vector<std::int32_t> CutMesh::elements_near(const CutSurface& surface, std::span<const Point> positions) const {
    Facet::Box all = surface.facets().front().bounds;
    for (const Facet& facet : surface.facets()) all = united(all, facet.bounds);
    std::vector<std::uint8_t> beyond;  // by node, or by copy
    const bool is_at_rest = positions.empty();
    for (const Point& place : is_at_rest ? mesh_->nodes() : positions) {
        beyond.push_back(static_cast<std::uint8_t>(sides_beyond(all, place)));
    }
    const std::span<const Tetrahedron> corners = is_at_rest ? mesh_->tetrahedra() : std::span(parts_);
    std::vector<std::int32_t> near;
    for (std::size_t part = 0; part < corners.size(); ++part) {
        const auto& [a, b, c, d] = corners[part];
        if ((beyond[a] & beyond[b] & beyond[c] & beyond[d]) == 0) near.push_back(element_of_part_[part]);
    }
    sort_unique(near);
    return near;
}

std::array<Point, 4> CutMesh::corners_of(std::int32_t part, std::span<const Point> positions) const {
    std::array<Point, 4> corners{};
    for (std::size_t k = 0; k < 4; ++k) {
        const auto copy = static_cast<std::size_t>(parts_[static_cast<std::size_t>(part)][k]);
        corners[k] =
            positions.empty() ? mesh_->nodes()[static_cast<std::size_t>(node_of_copy_[copy])] : positions[copy];
    }
    return corners;
}

void CutMesh::divide(std::int32_t element, const CutSurface& surface, FrontTreatment front,
                     std::span<const Point> positions, Change& change) {
    const std::span<const std::int32_t> own_parts = parts_in(element);
    std::vector<std::array<Point, 4>> corners;
    std::vector<std::vector<const Facet*>> near;
    bool is_near = false;
    for (const std::int32_t part : own_parts) {
        corners.push_back(corners_of(part, positions));
        // At rest all parts of an element are in one place.
        near.push_back(positions.empty() && !near.empty() ? near.front()
                                                          : facets_near(surface.facets(), corners.back()));
        is_near = is_near || !near.back().empty();
    }
    if (!is_near) return;
    const CutElement* known = cut_element(element);
    // Not a copy of one that is kept: cells are shared with what they are for, and other bodies may be cut meanwhile.
    ElementCells cells = known == nullptr ? ElementCells() : *known->cells;
    const std::vector<std::int32_t> old_parts(own_parts.begin(), own_parts.end());
    const std::size_t old_covers = cells.covers().size();
    bool is_touched = false;
    for (std::size_t p = 0; p < old_parts.size(); ++p) {
        is_touched = cells.divide(static_cast<int>(p), surface.shared_facets(), near[p], corners[p],
                                  front == FrontTreatment::extend) ||
                     is_touched;
    }
    if (!is_touched) return;
    change.touched.push_back(element);

    const std::vector<int> before = cells.regroup();
    CutElement divided{};
    divided.element = element;
    for (int p = 0; p < cells.parts(); ++p) divided.moments.push_back(cells.moments(p));
    // The largest piece of a part keeps its number.
    std::vector<int> largest(old_parts.size(), -1);
    for (std::size_t p = 0; p < before.size(); ++p) {
        int& best = largest[static_cast<std::size_t>(before[p])];
        if (best < 0 || divided.moments[p].fraction > divided.moments[static_cast<std::size_t>(best)].fraction) {
            best = static_cast<int>(p);
        }
    }
    for (std::size_t p = 0; p < before.size(); ++p) {
        const std::int32_t parent = old_parts[static_cast<std::size_t>(before[p])];
        if (largest[static_cast<std::size_t>(before[p])] == static_cast<int>(p)) {
            divided.parts.push_back(parent);
            continue;
        }
        const auto part = static_cast<std::int32_t>(parts_.size());
        divided.parts.push_back(part);
        parts_.push_back(parts_[static_cast<std::size_t>(parent)]);
        element_of_part_.push_back(element);
        parent_of_part_.push_back(parent);
        change.before[part] = parent;
    }
    const bool is_divided = before.size() > old_parts.size();
    if (is_divided) ++change.report.divided_elements;
    if (is_divided || cells.covers().size() > old_covers) change.opened.push_back(element);
    divided.cells = std::make_shared<const ElementCells>(std::move(cells));
    std::int32_t& place = place_[static_cast<std::size_t>(element)];
    if (place < 0) {
        place = static_cast<std::int32_t>(cut_elements_.size());
        cut_elements_.push_back(std::move(divided));
    } else {
        cut_elements_[static_cast<std::size_t>(place)] = std::move(divided);
    }
}

int CutMesh::corner_towards(std::int32_t element, std::int32_t neighbour) const {
    const auto& neighbours = base_->neighbours[static_cast<std::size_t>(element)];
    return static_cast<int>(std::ranges::find(neighbours, neighbour) - neighbours.begin());
}

/// A number for the face of an element opposite a corner, the same from both sides: that of the lower one.
std::int64_t CutMesh::face_of(std::int32_t element, int corner) const {
    const std::int32_t neighbour =
        base_->neighbours[static_cast<std::size_t>(element)][static_cast<std::size_t>(corner)];
    return element < neighbour || neighbour < 0
               ? 4 * static_cast<std::int64_t>(element) + corner
               : 4 * static_cast<std::int64_t>(neighbour) + corner_towards(neighbour, element);
}

void CutMesh::join_faces(std::int32_t element, Change& change) const {
    for (int corner = 0; corner < 4; ++corner) {
        if (base_->neighbours[static_cast<std::size_t>(element)][static_cast<std::size_t>(corner)] < 0) continue;
        const std::int64_t face = face_of(element, corner);
        const auto [place, is_new] = change.joints.try_emplace(face);
        if (!is_new) continue;
        const auto a = static_cast<std::int32_t>(face / 4);
        const int face_a = static_cast<int>(face % 4);
        const std::int32_t b = base_->neighbours[static_cast<std::size_t>(a)][static_cast<std::size_t>(face_a)];
        FaceSide side_a{.cells = cells(a), .face = face_a}, side_b{.cells = cells(b), .face = corner_towards(b, a)};
        const Tetrahedron &nodes_a = mesh_->tetrahedra()[static_cast<std::size_t>(a)],
                          &nodes_b = mesh_->tetrahedra()[static_cast<std::size_t>(b)];
        for (int k = 0; k < 3; ++k) {
            const int corner_a = (face_a + 1 + k) % 4;
            side_a.corners[static_cast<std::size_t>(k)] = corner_a;
            side_b.corners[static_cast<std::size_t>(k)] = static_cast<int>(
                std::ranges::find(nodes_b, nodes_a[static_cast<std::size_t>(corner_a)]) - nodes_b.begin());
        }
        const std::span<const std::int32_t> parts_a = parts_in(a), parts_b = parts_in(b);
        const auto old = joints_.find(face);
        const auto may_join = [&](int p, int q) {
            if (old == joints_.end()) return true;
            const std::pair before(change.part_before(parts_a[static_cast<std::size_t>(p)]),
                                   change.part_before(parts_b[static_cast<std::size_t>(q)]));
            return std::ranges::find(old->second, before) != old->second.end();
        };
        for (const auto& [p, q] : joined_parts(side_a, side_b, may_join)) {
            place->second.emplace_back(parts_a[static_cast<std::size_t>(p)], parts_b[static_cast<std::size_t>(q)]);
        }
    }
}

void CutMesh::regroup_copies(std::int32_t node) {
    struct Member {
        std::int32_t part;
        int corner;
        bool is_at_node;
        double fraction;
    };
    const std::span<const std::int32_t> star = base_->stars.of(node);
    std::vector<Member> members;
    std::vector<std::int32_t> first;  // of the members of each element around the node
    for (const std::int32_t element : star) {
        const Tetrahedron& nodes = mesh_->tetrahedra()[static_cast<std::size_t>(element)];
        const int corner = static_cast<int>(std::ranges::find(nodes, node) - nodes.begin());
        const CutElement* cut = cut_element(element);
        first.push_back(static_cast<std::int32_t>(members.size()));
        if (cut == nullptr) {
            members.push_back({element, corner, true, 1});
            continue;
        }
        for (std::size_t p = 0; p < cut->parts.size(); ++p) {
            members.push_back(
                {cut->parts[p], corner, cut->cells->touches(static_cast<int>(p), corner), cut->moments[p].fraction});
        }
    }
    first.push_back(static_cast<std::int32_t>(members.size()));
    const auto copy_of = [&](std::int32_t member) -> std::int32_t& {
        return parts_[static_cast<std::size_t>(members[member].part)][static_cast<std::size_t>(members[member].corner)];
    };
    const auto member_of = [&](std::size_t in_star, std::int32_t part) {
        std::int32_t member = first[in_star];
        while (members[member].part != part) ++member;
        return member;
    };
    std::vector<std::int32_t> group(members.size()), elements(members.size());
    std::iota(group.begin(), group.end(), 0);
    elements = group;  // the same, had nothing been cut
    const auto join = [&](std::int32_t a, std::int32_t b) {
        if (copy_of(a) == copy_of(b)) unite(group, a, b);
    };
    for (std::size_t s = 0; s < star.size(); ++s) {
        const std::int32_t element = star[s];
        for (std::int32_t member = first[s] + 1; member < first[s + 1]; ++member) unite(elements, first[s], member);
        const Tetrahedron& nodes = mesh_->tetrahedra()[static_cast<std::size_t>(element)];
        for (int corner = 0; corner < 4; ++corner) {
            const std::int32_t neighbour =
                base_->neighbours[static_cast<std::size_t>(element)][static_cast<std::size_t>(corner)];
            if (neighbour < element || nodes[static_cast<std::size_t>(corner)] == node) continue;
            const auto other = static_cast<std::size_t>(std::ranges::find(star, neighbour) - star.begin());
            unite(elements, first[s], first[other]);
            const bool is_cut = cut_element(element) != nullptr || cut_element(neighbour) != nullptr;
            const auto joints = is_cut ? joints_.find(4 * static_cast<std::int64_t>(element) + corner) : joints_.end();
            if (joints == joints_.end()) {
                join(member_of(s, element), member_of(other, neighbour));
            } else {
                for (const auto& [a, b] : joints->second) join(member_of(s, a), member_of(other, b));
            }
        }
    }
    // Elements that share the node but no face around it hang together at the node itself.
    std::vector<std::pair<std::int32_t, std::int32_t>> at_node;  // {what hangs together, member}
    for (std::size_t m = 0; m < members.size(); ++m) {
        const auto member = static_cast<std::int32_t>(m);
        if (members[m].is_at_node) at_node.emplace_back(find(elements, member), member);
    }
    if (!at_node.empty()) {
        const auto [lowest, first_member] = *std::ranges::min_element(at_node);
        for (const auto& [root, member] : at_node) {
            const bool is_first =
                std::ranges::find(at_node, root, [](const auto& one) { return one.first; })->second == member;
            if (root != lowest && is_first) join(first_member, member);
        }
    }

    // Of each copy, the group that holds the node keeps the number; the largest, where several touch it or none.
    struct Group {
        std::int32_t copy, first;
        bool is_at_node = false;
        double size = 0;
    };
    std::vector<Group> groups;
    std::vector<std::int32_t> number(members.size(), -1);  // by the group's first member
    for (std::size_t m = 0; m < members.size(); ++m) {
        const auto member = static_cast<std::int32_t>(m);
        const std::int32_t root = find(group, member);
        if (number[root] < 0) {
            number[root] = static_cast<std::int32_t>(groups.size());
            groups.push_back({copy_of(member), root});
        }
        Group& found = groups[number[root]];
        found.is_at_node = found.is_at_node || members[m].is_at_node;
        found.size += members[m].fraction * mesh_->volume(element_of_part_[static_cast<std::size_t>(members[m].part)]);
    }
    std::ranges::sort(groups, {}, [](const Group& one) { return std::pair(one.copy, one.first); });
    for (auto begin = groups.begin(); begin != groups.end();) {
        const std::int32_t copy = begin->copy;
        const auto end = std::find_if(begin, groups.end(), [&](const Group& one) { return one.copy != copy; });
        const auto keeper = std::max_element(begin, end, [](const Group& a, const Group& b) {
            return std::pair(a.is_at_node, a.size) < std::pair(b.is_at_node, b.size);
        });
        for (auto one = begin; one != end; ++one) {
            if (one == keeper) continue;
            const auto new_copy = static_cast<std::int32_t>(node_of_copy_.size());
            node_of_copy_.push_back(node);
            parent_of_copy_.push_back(copy);
            further_copies_[node].push_back(new_copy);
            for (std::size_t m = 0; m < members.size(); ++m) {
                const auto member = static_cast<std::int32_t>(m);
                if (find(group, member) == one->first) copy_of(member) = new_copy;
            }
        }
        begin = end;
    }
}

PartMoments CutMesh::moments(std::int32_t part) const {
    const CutElement* cut = cut_element(element_of_part_[static_cast<std::size_t>(part)]);
    if (cut == nullptr) return {};
    return cut->moments[static_cast<std::size_t>(std::ranges::find(cut->parts, part) - cut->parts.begin())];
}

std::vector<std::int32_t> CutMesh::copies_of_node(std::int32_t node) const {
    std::vector<std::int32_t> copies{node};
    const auto found = further_copies_.find(node);
    if (found != further_copies_.end()) copies.insert(copies.end(), found->second.begin(), found->second.end());
    return copies;
}

std::span<const std::int32_t> CutMesh::parts_in(std::int32_t element) const {
    if (const CutElement* cut = cut_element(element)) return cut->parts;
    return {&element_of_part_[static_cast<std::size_t>(element)], 1};  // the number of its only part is its own
}

std::vector<std::int32_t> CutMesh::parts_of_element(std::int32_t element) const {
    const std::span<const std::int32_t> parts = parts_in(element);
    return {parts.begin(), parts.end()};
}

std::vector<Point> CutMesh::rest_positions() const {
    std::vector<Point> positions;
    positions.reserve(node_of_copy_.size());
    for (const std::int32_t node : node_of_copy_) positions.push_back(mesh_->nodes()[static_cast<std::size_t>(node)]);
    return positions;
}

CutMesh::FaceState CutMesh::face_state(std::int32_t part, int corner) const {
    const std::int32_t element = element_of_part_[static_cast<std::size_t>(part)];
    if (base_->neighbours[static_cast<std::size_t>(element)][static_cast<std::size_t>(corner)] < 0) {
        return FaceState::outer;
    }
    const auto joints = joints_.find(face_of(element, corner));
    if (joints == joints_.end()) return FaceState::joined;
    const bool is_joined = std::ranges::any_of(
        joints->second, [&](const auto& pair) { return pair.first == part || pair.second == part; });
    return is_joined ? FaceState::joined : FaceState::opened;
}

std::vector<std::int32_t> CutMesh::touched_elements() const {
    std::vector<std::int32_t> elements;
    for (const CutElement& cut : cut_elements_) elements.push_back(cut.element);
    std::ranges::sort(elements);
    return elements;
}

const ElementCells* CutMesh::cells(std::int32_t element) const {
    const CutElement* cut = cut_element(element);
    return cut == nullptr ? nullptr : cut->cells.get();
}

MaterialPoint CutMesh::material_point(std::int32_t element, const Barycentric& place) const {
    const CutElement* cut = cut_element(element);
    if (cut == nullptr) return {element, place};
    return {cut->parts[static_cast<std::size_t>(cut->cells->part_at(place))], place};
}

}  // namespace lancet::mesh
