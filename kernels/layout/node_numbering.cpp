#include "lancet/kernels/layout/node_numbering.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>
#include <tuple>

#include "lancet/kernels/error.hpp"
#include "lancet/kernels/layout/aligned_vector.hpp"
#include "lancet/kernels/layout/spare_nodes.hpp"

namespace lancet::kernels {

namespace {

using Indices = std::span<std::int32_t>;

int longest_axis(std::span<const Point> positions, Indices nodes) {
    Point low{}, high{};
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
    for (const std::int32_t node : nodes) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], positions[node][axis]);
            high[axis] = std::max(high[axis], positions[node][axis]);
        }
    }
    int longest = 0;
    for (int axis = 1; axis < 3; ++axis) {
        if (high[axis] - low[axis] > high[longest] - low[longest]) longest = axis;
    }
    return longest;
}

/// Recursive coordinate bisection of `nodes` into `parts` pieces of nearly equal size, appended in order.
void bisect(std::span<const Point> positions, std::span<const std::int32_t> rank, Indices nodes, int parts,
            std::vector<Indices>& pieces) {
    if (parts == 1 || nodes.size() <= 1) {
        std::sort(nodes.begin(), nodes.end(), [&](auto a, auto b) { return rank[a] < rank[b]; });
        pieces.push_back(nodes);
        return;
    }
    const int left_parts = parts / 2;
    const std::size_t middle = nodes.size() * static_cast<std::size_t>(left_parts) / static_cast<std::size_t>(parts);
    const int axis = longest_axis(positions, nodes);
    std::nth_element(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(middle), nodes.end(),
                     [&](auto a, auto b) {
                         return std::tuple(positions[a][axis], rank[a]) < std::tuple(positions[b][axis], rank[b]);
                     });
    bisect(positions, rank, nodes.first(middle), left_parts, pieces);
    bisect(positions, rank, nodes.subspan(middle), parts - left_parts, pieces);
}

std::int32_t find_root(std::vector<std::int32_t>& parent, std::int32_t node) {
    while (parent[node] != node) node = parent[node] = parent[parent[node]];
    return node;
}

/// For each node a node that stands for its connected piece of its aggregate.
std::vector<std::int32_t> connected_pieces(std::span<const Tetrahedron> tetrahedra,
                                           const std::vector<std::int32_t>& aggregate) {
    std::vector<std::int32_t> parent(aggregate.size());
    std::iota(parent.begin(), parent.end(), 0);
    for (const Tetrahedron& element : tetrahedra) {
        for (int i = 0; i < 4; ++i) {
            for (int j = i + 1; j < 4; ++j) {
                if (aggregate[element[i]] < 0 || aggregate[element[i]] != aggregate[element[j]]) continue;
                const std::int32_t a = find_root(parent, element[i]), b = find_root(parent, element[j]);
                parent[std::max(a, b)] = std::min(a, b);
            }
        }
    }
    for (std::size_t node = 0; node < parent.size(); ++node) {
        parent[node] = find_root(parent, static_cast<std::int32_t>(node));
    }
    return parent;
}

int divide_rounding_up(std::size_t count, int unit) {
    return static_cast<int>((count + static_cast<std::size_t>(unit) - 1) / static_cast<std::size_t>(unit));
}

void append(NodeNumbering& numbering, Indices nodes) {
    for (const std::int32_t node : nodes) {
        numbering.internal_of_user[node] = static_cast<std::int32_t>(numbering.user_of_internal.size());
        numbering.user_of_internal.push_back(node);
    }
    while (numbering.user_of_internal.size() % NodeNumbering::alignment != 0) numbering.user_of_internal.push_back(-1);
}

/// One block more, without a node yet, and the aggregates that it may come to.
void add_room(NodeNumbering& numbering, int nodes) {
    const auto first = static_cast<std::int32_t>(numbering.user_of_internal.size());
    const int aggregates = divide_rounding_up(static_cast<std::size_t>(nodes), SpareNodes::nodes_per_aggregate);
    for (int k = 1; k <= aggregates; ++k) {
        numbering.aggregate_begin.push_back(first + k * SpareNodes::nodes_per_aggregate);
    }
    numbering.user_of_internal.resize(static_cast<std::size_t>(numbering.aggregate_begin.back()), -1);
    numbering.block_begin.push_back(first);
    numbering.block_aggregate_begin.push_back(numbering.block_aggregate_begin.back());
}

}  // namespace

int NodeNumbering::block_of(std::int32_t node) const noexcept {
    return static_cast<int>(std::upper_bound(block_begin.begin(), block_begin.end(), node) - block_begin.begin()) - 1;
}

std::size_t NodeNumbering::bytes() const noexcept {
    return heap_bytes(internal_of_user) + heap_bytes(user_of_internal) + heap_bytes(aggregate_begin) +
           heap_bytes(block_begin) + heap_bytes(block_aggregate_begin) + heap_bytes(sleeping.nodes) +
           heap_bytes(sleeping.blocks) + heap_bytes(sleeping.awake_blocks);
}

NodeNumbering number_nodes(std::span<const Point> positions, std::span<const Tetrahedron> tetrahedra,
                           std::span<const std::uint8_t> fixed, std::span<const std::int32_t> rank,
                           const NumberingOptions& options) {
    if (fixed.size() != positions.size() || rank.size() != positions.size()) {
        throw Error("node numbering: " + std::to_string(positions.size()) + " nodes, but " +
                    std::to_string(fixed.size()) + " fixed flags and " + std::to_string(rank.size()) + " ranks");
    }
    std::vector<std::int32_t> free_nodes, fixed_nodes;
    for (std::size_t node = 0; node < positions.size(); ++node) {
        (fixed[node] != 0 ? fixed_nodes : free_nodes).push_back(static_cast<std::int32_t>(node));
    }

    // About ten blocks keep two to ten threads busy on small bodies; a block of a thousand nodes fits the second-level
    // cache on large ones. An aggregate of some 340 nodes gives the coarse space its best ratio of gain to cost.
    const int nodes_per_block = options.nodes_per_block > 0
                                    ? options.nodes_per_block
                                    : std::clamp(divide_rounding_up(free_nodes.size(), 10), 64, 1024);
    const int nodes_per_aggregate = options.nodes_per_aggregate > 0 ? options.nodes_per_aggregate : 340;
    std::vector<Indices> blocks;
    if (!free_nodes.empty()) {
        bisect(positions, rank, free_nodes, divide_rounding_up(free_nodes.size(), nodes_per_block), blocks);
    }

    std::vector<std::vector<Indices>> aggregates(blocks.size());
    std::vector<std::int32_t> aggregate_of(positions.size(), -1);
    std::int32_t label = 0;
    for (std::size_t block = 0; block < blocks.size(); ++block) {
        const int parts = static_cast<int>((blocks[block].size() + static_cast<std::size_t>(nodes_per_aggregate) / 2) /
                                           static_cast<std::size_t>(nodes_per_aggregate));
        bisect(positions, rank, blocks[block], std::max(1, parts), aggregates[block]);
        for (const Indices nodes : aggregates[block]) {
            for (const std::int32_t node : nodes) aggregate_of[node] = label;
            ++label;
        }
    }
    const std::vector<std::int32_t> piece = connected_pieces(tetrahedra, aggregate_of);

    NodeNumbering numbering;
    numbering.internal_of_user.assign(positions.size(), -1);
    numbering.block_begin.push_back(0);
    numbering.block_aggregate_begin.push_back(0);
    for (std::vector<Indices>& block : aggregates) {
        for (Indices nodes : block) {
            std::stable_sort(nodes.begin(), nodes.end(), [&](auto a, auto b) { return piece[a] < piece[b]; });
            for (std::size_t begin = 0; begin < nodes.size();) {
                std::size_t end = begin;
                while (end < nodes.size() && piece[nodes[end]] == piece[nodes[begin]]) ++end;
                numbering.aggregate_begin.push_back(static_cast<std::int32_t>(numbering.user_of_internal.size()));
                append(numbering, nodes.subspan(begin, end - begin));
                begin = end;
            }
        }
        numbering.block_begin.push_back(static_cast<std::int32_t>(numbering.user_of_internal.size()));
        numbering.block_aggregate_begin.push_back(static_cast<std::int32_t>(numbering.aggregate_begin.size()));
    }
    numbering.spare_begin = static_cast<std::int32_t>(numbering.user_of_internal.size());
    numbering.aggregate_begin.push_back(numbering.spare_begin);
    if (options.spare_nodes > 0 && !free_nodes.empty()) add_room(numbering, options.spare_nodes);
    numbering.free_count = static_cast<std::int32_t>(numbering.user_of_internal.size());
    std::sort(fixed_nodes.begin(), fixed_nodes.end(), [&](auto a, auto b) { return rank[a] < rank[b]; });
    append(numbering, fixed_nodes);
    if (numbering.has_room() && !fixed_nodes.empty()) {
        const int spare =
            std::min(options.spare_nodes, static_cast<int>(fixed_nodes.size()) + NodeNumbering::alignment);
        const auto size = numbering.user_of_internal.size() + static_cast<std::size_t>(spare);
        numbering.user_of_internal.resize(
            (size + NodeNumbering::alignment - 1) / NodeNumbering::alignment * NodeNumbering::alignment, -1);
    }
    numbering.node_count = static_cast<std::int32_t>(numbering.user_of_internal.size());
    return numbering;
}

}  // namespace lancet::kernels
