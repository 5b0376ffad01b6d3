#include "lancet/mesh/cut/cut_mesh.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <set>
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

}  // namespace

/// What a cut has done so far.
struct CutMesh::Change {
    std::set<std::int32_t> elements{};              ///< that were touched
    std::map<std::int32_t, std::int32_t> before{};  ///< part -> the part that it was, where that is another
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

    const auto start_topology = Clock::now();
    std::map<FaceKey, PartPairs> joints;
    for (const std::int32_t element : change.elements) join_faces(element, change, joints);
    for (auto& [key, pairs] : joints) joints_[key] = std::move(pairs);
    std::set<std::int32_t> nodes;
    for (const std::int32_t element : change.elements) {
        const Tetrahedron& corners = mesh_->tetrahedra()[static_cast<std::size_t>(element)];
        nodes.insert(corners.begin(), corners.end());
    }
    for (const std::int32_t node : nodes) regroup_copies(node);
    change.report.seconds_topology = seconds_since(start_topology);

    change.report.elements.assign(change.elements.begin(), change.elements.end());
    change.report.touched_elements = static_cast<std::int32_t>(change.elements.size());
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
    std::vector<std::int32_t> near;
    for (std::size_t part = 0; part < parts_.size(); ++part) {
        const std::array<Point, 4> corners = corners_of(static_cast<std::int32_t>(part), positions);
        if (!overlap(all, corners)) continue;
        if (std::ranges::any_of(surface.facets(), [&](const Facet& facet) { return may_touch(facet, corners); })) {
            near.push_back(element_of_part_[part]);
        }
    }
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
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
    const auto found = cells_.find(element);
    const bool is_new = found == cells_.end();
    auto cells = is_new ? ElementCells() : *found->second.cells;
    const std::vector<std::int32_t> old_parts = is_new ? std::vector{element} : found->second.parts;
    bool is_touched = false;
    for (std::size_t p = 0; p < old_parts.size(); ++p) {
        is_touched = cells.divide(static_cast<int>(p), surface.shared_facets(), corners_of(old_parts[p], positions),
                                  front == FrontTreatment::extend) ||
                     is_touched;
    }
    if (!is_touched) return;
    change.elements.insert(element);

    const std::vector<int> before = cells.regroup();
    CutElement divided;
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
    if (before.size() > old_parts.size()) ++change.report.divided_elements;
    divided.cells = std::make_shared<const ElementCells>(std::move(cells));
    cells_[element] = std::move(divided);
}

int CutMesh::corner_towards(std::int32_t element, std::int32_t neighbour) const {
    const auto& neighbours = base_->neighbours[static_cast<std::size_t>(element)];
    return static_cast<int>(std::ranges::find(neighbours, neighbour) - neighbours.begin());
}

CutMesh::FaceKey CutMesh::key_of(std::int32_t element, int corner) const {
    const std::int32_t neighbour =
        base_->neighbours[static_cast<std::size_t>(element)][static_cast<std::size_t>(corner)];
    return element < neighbour ? FaceKey{element, corner} : FaceKey{neighbour, corner_towards(neighbour, element)};
}

void CutMesh::join_faces(std::int32_t element, const Change& change, std::map<FaceKey, PartPairs>& joints) const {
    for (int corner = 0; corner < 4; ++corner) {
        if (base_->neighbours[static_cast<std::size_t>(element)][static_cast<std::size_t>(corner)] < 0) continue;
        const FaceKey key = key_of(element, corner);
        if (joints.contains(key)) continue;
        const std::int32_t a = key.first;
        const std::int32_t b = base_->neighbours[static_cast<std::size_t>(a)][static_cast<std::size_t>(key.second)];
        FaceSide side_a{.cells = cells(a), .face = key.second}, side_b{.cells = cells(b), .face = corner_towards(b, a)};
        const Tetrahedron &nodes_a = mesh_->tetrahedra()[static_cast<std::size_t>(a)],
                          &nodes_b = mesh_->tetrahedra()[static_cast<std::size_t>(b)];
        for (int k = 0; k < 3; ++k) {
            const int corner_a = (key.second + 1 + k) % 4;
            side_a.corners[static_cast<std::size_t>(k)] = corner_a;
            side_b.corners[static_cast<std::size_t>(k)] = static_cast<int>(
                std::ranges::find(nodes_b, nodes_a[static_cast<std::size_t>(corner_a)]) - nodes_b.begin());
        }
        const std::vector<std::int32_t> parts_a = parts_of_element(a), parts_b = parts_of_element(b);
        const auto old = joints_.find(key);
        const auto may_join = [&](int p, int q) {
            if (old == joints_.end()) return true;
            const std::pair before(change.part_before(parts_a[static_cast<std::size_t>(p)]),
                                   change.part_before(parts_b[static_cast<std::size_t>(q)]));
            return std::ranges::find(old->second, before) != old->second.end();
        };
        PartPairs& pairs = joints[key];
        for (const auto& [p, q] : joined_parts(side_a, side_b, may_join)) {
            pairs.emplace_back(parts_a[static_cast<std::size_t>(p)], parts_b[static_cast<std::size_t>(q)]);
        }
    }
}

bool CutMesh::touches(std::int32_t part, int corner) const {
    const auto found = cells_.find(element_of_part_[static_cast<std::size_t>(part)]);
    if (found == cells_.end()) return true;
    const auto local = std::ranges::find(found->second.parts, part) - found->second.parts.begin();
    return found->second.cells->touches(static_cast<int>(local), corner);
}

void CutMesh::regroup_copies(std::int32_t node) {
    struct Member {
        std::int32_t part;
        int corner;
    };
    std::vector<Member> members;
    std::map<std::int32_t, std::int32_t> place;  // part -> member
    const std::span<const std::int32_t> star = base_->stars.of(node);
    for (const std::int32_t element : star) {
        const Tetrahedron& nodes = mesh_->tetrahedra()[static_cast<std::size_t>(element)];
        const int corner = static_cast<int>(std::ranges::find(nodes, node) - nodes.begin());
        for (const std::int32_t part : parts_of_element(element)) {
            place[part] = static_cast<std::int32_t>(members.size());
            members.push_back({part, corner});
        }
    }
    const auto copy_of = [&](std::int32_t member) -> std::int32_t& {
        return parts_[static_cast<std::size_t>(members[member].part)][static_cast<std::size_t>(members[member].corner)];
    };
    std::vector<std::int32_t> group(members.size()), elements(members.size());
    std::iota(group.begin(), group.end(), 0);
    elements = group;  // the same, had nothing been cut
    const auto join = [&](std::int32_t a, std::int32_t b) {
        if (copy_of(place.at(a)) == copy_of(place.at(b))) unite(group, place.at(a), place.at(b));
    };
    for (const std::int32_t element : star) {
        const std::vector<std::int32_t> parts = parts_of_element(element);
        for (const std::int32_t part : parts) unite(elements, place.at(parts.front()), place.at(part));
        const Tetrahedron& nodes = mesh_->tetrahedra()[static_cast<std::size_t>(element)];
        for (int corner = 0; corner < 4; ++corner) {
            const std::int32_t neighbour =
                base_->neighbours[static_cast<std::size_t>(element)][static_cast<std::size_t>(corner)];
            if (neighbour < element || nodes[static_cast<std::size_t>(corner)] == node) continue;
            unite(elements, place.at(parts.front()), place.at(parts_of_element(neighbour).front()));
            const auto joints = joints_.find({element, corner});
            if (joints == joints_.end()) {
                join(element, neighbour);
            } else {
                for (const auto& [a, b] : joints->second) join(a, b);
            }
        }
    }
    // Elements that share the node but no face around it hang together at the node itself.
    std::map<std::int32_t, std::int32_t> at_node;
    for (std::size_t m = 0; m < members.size(); ++m) {
        const auto member = static_cast<std::int32_t>(m);
        if (touches(members[m].part, members[m].corner)) at_node.try_emplace(find(elements, member), member);
    }
    for (const auto& [first, member] : at_node) {
        join(members[at_node.begin()->second].part, members[member].part);
    }

    // Of each copy, the group that holds the node keeps the number; the largest, where several touch it or none.
    struct Group {
        bool is_at_node = false;
        double size = 0;
        std::vector<std::int32_t> members{};
    };
    std::map<std::int32_t, std::map<std::int32_t, Group>> groups_of_copy;
    for (std::size_t m = 0; m < members.size(); ++m) {
        const auto member = static_cast<std::int32_t>(m);
        Group& found = groups_of_copy[copy_of(member)][find(group, member)];
        found.is_at_node = found.is_at_node || touches(members[m].part, members[m].corner);
        found.size += moments(members[m].part).fraction *
                      mesh_->volume(element_of_part_[static_cast<std::size_t>(members[m].part)]);
        found.members.push_back(member);
    }
    for (const auto& [copy, groups] : groups_of_copy) {
        const auto keeper = std::ranges::max_element(
            groups, {}, [](const auto& entry) { return std::pair(entry.second.is_at_node, entry.second.size); });
        for (auto it = groups.begin(); it != groups.end(); ++it) {
            if (it == keeper) continue;
            const auto new_copy = static_cast<std::int32_t>(node_of_copy_.size());
            node_of_copy_.push_back(node);
            parent_of_copy_.push_back(copy);
            further_copies_[node].push_back(new_copy);
            for (const std::int32_t member : it->second.members) copy_of(member) = new_copy;
        }
    }
}

PartMoments CutMesh::moments(std::int32_t part) const {
    const auto found = cells_.find(element_of_part_[static_cast<std::size_t>(part)]);
    if (found == cells_.end()) return {};
    const auto local = std::ranges::find(found->second.parts, part) - found->second.parts.begin();
    return found->second.moments[static_cast<std::size_t>(local)];
}

std::vector<std::int32_t> CutMesh::copies_of_node(std::int32_t node) const {
    std::vector<std::int32_t> copies{node};
    const auto found = further_copies_.find(node);
    if (found != further_copies_.end()) copies.insert(copies.end(), found->second.begin(), found->second.end());
    return copies;
}

std::vector<std::int32_t> CutMesh::parts_of_element(std::int32_t element) const {
    const auto found = cells_.find(element);
    return found == cells_.end() ? std::vector{element} : found->second.parts;
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
    const auto joints = joints_.find(key_of(element, corner));
    if (joints == joints_.end()) return FaceState::joined;
    const bool is_joined = std::ranges::any_of(
        joints->second, [&](const auto& pair) { return pair.first == part || pair.second == part; });
    return is_joined ? FaceState::joined : FaceState::opened;
}

std::vector<std::int32_t> CutMesh::touched_elements() const {
    std::vector<std::int32_t> elements;
    for (const auto& [element, cells] : cells_) elements.push_back(element);
    return elements;
}

const ElementCells* CutMesh::cells(std::int32_t element) const {
    const auto found = cells_.find(element);
    return found == cells_.end() ? nullptr : found->second.cells.get();
}

MaterialPoint CutMesh::material_point(std::int32_t element, const Barycentric& place) const {
    const auto found = cells_.find(element);
    if (found == cells_.end()) return {element, place};
    const ElementCells& cells = *found->second.cells;
    return {found->second.parts[static_cast<std::size_t>(cells.part_at(place))], place};
}

}  // namespace lancet::mesh
