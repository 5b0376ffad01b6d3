#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lancet::kernels {

/// Nodes that passes over a body leave where they are for a while, and the blocks that they leave out for that.
struct SleepingNodes {
    std::vector<std::uint8_t> nodes{};         ///< [internal node] 1: asleep; empty: none is
    std::vector<std::uint8_t> blocks{};        ///< [block] 1: with all its nodes and elements; empty: none is
    std::vector<std::int32_t> awake_blocks{};  ///< the others, ascending
    bool are_left_out = false;                 ///< passes go over awake_blocks alone

    bool empty() const noexcept { return nodes.empty(); }
    bool has(std::int32_t node) const noexcept { return !nodes.empty() && nodes[static_cast<std::size_t>(node)] != 0; }
    /// Whether passes leave a block out.
    bool leave_out(int block) const noexcept { return are_left_out && blocks[static_cast<std::size_t>(block)] != 0; }
};

}  // namespace lancet::kernels
