#include "lancet/runtime/simulate/carried_points.hpp"

#include <algorithm>

#include "lancet/mesh/embed/embedding.hpp"

namespace lancet::runtime {

namespace {

constexpr std::size_t points_per_block = 1024;

/// The part of a group of points that a block has, the groups following each other.
template <class Group>
std::span<const Group> part_of_block(const std::vector<Group>& group, std::size_t group_begin, std::size_t begin,
                                     std::size_t end) {
    const auto clamp = [&](std::size_t at) {
        return std::clamp(at, group_begin, group_begin + group.size()) - group_begin;
    };
    return std::span(group).subspan(clamp(begin), clamp(end) - clamp(begin));
}

}  // namespace

void CarriedPoints::add(const mesh::MaterialPoint& point, const mesh::Tetrahedron& of_part) {
    const auto number = static_cast<std::int32_t>(size());
    parts.push_back(point.part);
    nodes.push_back(of_part);
    weights.push_back(point.weights);
    std::array<std::size_t, 4> used{};
    std::size_t count = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        if (point.weights[k] != 0) used[count++] = k;
    }
    if (count == 1 && point.weights[used[0]] == 1) {
        on_nodes_.push_back({number, of_part[used[0]]});
    } else if (count == 2) {
        on_edges_.push_back(
            {number, {of_part[used[0]], of_part[used[1]]}, {point.weights[used[0]], point.weights[used[1]]}});
    } else {
        inside_.push_back(number);
    }
    if (on_nodes_.size() == size()) {
        as_nodes_.push_back(on_nodes_.back().node);
    } else {
        as_nodes_ = {};
    }
}

void CarriedPoints::place(Scheduler& scheduler, std::span<const Point> positions, std::vector<Point>& places) const {
    places.resize(size());
    const auto at = [&](std::int32_t node) -> const Point& { return positions[static_cast<std::size_t>(node)]; };
    const auto blocks = static_cast<int>((size() + points_per_block - 1) / points_per_block);
    scheduler.for_each_block(blocks, [&](int block) {
        const std::size_t begin = static_cast<std::size_t>(block) * points_per_block, end = begin + points_per_block;
        for (const OnNode& point : part_of_block(on_nodes_, 0, begin, end)) {
            places[static_cast<std::size_t>(point.point)] = at(point.node);
        }
        for (const OnEdge& point : part_of_block(on_edges_, on_nodes_.size(), begin, end)) {
            const Point &from = at(point.nodes[0]), &to = at(point.nodes[1]);
            Point& place = places[static_cast<std::size_t>(point.point)];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                place[axis] = point.weights[0] * from[axis] + point.weights[1] * to[axis];
            }
        }
        for (const std::int32_t point : part_of_block(inside_, on_nodes_.size() + on_edges_.size(), begin, end)) {
            const auto p = static_cast<std::size_t>(point);
            places[p] = mesh::place(nodes[p], weights[p], positions);
        }
    });
}

}  // namespace lancet::runtime
