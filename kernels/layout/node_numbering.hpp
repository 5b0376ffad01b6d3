#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lancet/kernels/layout/sleeping_nodes.hpp"

namespace lancet::kernels {

using Point = std::array<double, 3>;
using Tetrahedron = std::array<std::int32_t, 4>;

/// How nodes are divided. Zero means: chosen from the number of nodes.
struct NumberingOptions {
    int nodes_per_block = 0;      ///< work unit of a scheduler; does not depend on the number of threads
    int nodes_per_aggregate = 0;  ///< piece whose rigid motions the coarse space holds
    /// Room for so many nodes that come later (see SpareNodes), which a body that is cut takes up without being laid
    /// out anew. Everything that is laid out by the numbering keeps room in proportion.
    int spare_nodes = 0;
};

/// The solver's own order of the nodes. Free nodes come first, divided into blocks and each block into aggregates;
/// every aggregate starts at a multiple of `alignment` and is filled up with unused nodes that belong to no element,
/// so that vector passes need no tails. Fixed nodes follow behind the free ones and are in no block.
///
/// Room for further nodes is one block more, the last one. It begins without a node, and grows by whole aggregates:
/// block_begin.back() and block_aggregate_begin.back() are where it ends so far. What is behind is in no pass.
struct NodeNumbering {
    static constexpr int alignment = 16;  ///< the widest batch

    std::int32_t free_count = 0;   ///< free nodes occupy [0, free_count), unused ones included
    std::int32_t node_count = 0;   ///< all nodes; a multiple of `alignment`
    std::int32_t spare_begin = 0;  ///< room for further free nodes: [spare_begin, free_count)
    std::vector<std::int32_t> internal_of_user;
    std::vector<std::int32_t> user_of_internal;       ///< -1 where unused
    std::vector<std::int32_t> aggregate_begin;        ///< first node of each aggregate, and the end
    std::vector<std::int32_t> block_begin;            ///< first node of each block, and the end
    std::vector<std::int32_t> block_aggregate_begin;  ///< first aggregate of each block, and the end
    SleepingNodes sleeping;                           ///< those of now

    int blocks() const noexcept { return static_cast<int>(block_begin.size()) - 1; }
    int aggregates() const noexcept { return static_cast<int>(aggregate_begin.size()) - 1; }
    bool is_free(std::int32_t node) const noexcept { return node < free_count; }
    bool has_room() const noexcept { return spare_begin < free_count; }
    /// Blocks without the one that is room.
    int first_blocks() const noexcept { return blocks() - (has_room() ? 1 : 0); }
    /// The block of a free node.
    int block_of(std::int32_t node) const noexcept;
    std::size_t bytes() const noexcept;
};

/// Divides the free nodes into blocks of equal size by recursive bisection along the longest extent, the blocks into
/// aggregates in the same way, splits aggregates that are not connected, and orders the nodes of each by `rank`.
/// - positions, fixed, rank: one per node; rank is the node's place in the order of the mesh
/// - tetrahedra: indices into positions
NodeNumbering number_nodes(std::span<const Point> positions, std::span<const Tetrahedron> tetrahedra,
                           std::span<const std::uint8_t> fixed, std::span<const std::int32_t> rank,
                           const NumberingOptions& options = {});

}  // namespace lancet::kernels
