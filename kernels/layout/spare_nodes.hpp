#pragma once

#include <cstdint>
#include <span>

#include "lancet/kernels/layout/node_numbering.hpp"

namespace lancet::kernels {

/// Hands out the room of a numbering. Nodes that are neighbours come into one aggregate as long as it has room, so that
/// the aggregates of what lies along one side of a cut are connected.
class SpareNodes {
  public:
    /// Aggregates of the room are small: cuts at different places should not share one, and every pass takes all nodes
    /// of those that are in use.
    static constexpr std::int32_t nodes_per_aggregate = 32;

    SpareNodes() = default;
    explicit SpareNodes(const NodeNumbering& numbering) : next_fixed_(numbering.free_count) {}

    /// Gives a place to a node: returns its internal number, or -1 where there is no room.
    /// - neighbours: internal numbers of nodes that share an element with it, -1 among them for none
    std::int32_t take(NodeNumbering& numbering, std::int32_t user, bool is_fixed,
                      std::span<const std::int32_t> neighbours);
    /// Takes a node out of the numbering that `take` put there; its place is free again.
    static void give_back(NodeNumbering& numbering, std::int32_t node) { numbering.user_of_internal[node] = -1; }

  private:
    std::int32_t take_fixed(NodeNumbering& numbering, std::int32_t user);

    std::int32_t next_fixed_ = 0;  ///< no place before it is free
};

}  // namespace lancet::kernels
