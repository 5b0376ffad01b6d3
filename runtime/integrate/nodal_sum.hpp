#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "lancet/kernels/layout/node_numbering.hpp"
#include "lancet/runtime/solve/block_loop.hpp"

namespace lancet::runtime {

/// The sum of value(node, 4 * node) over the free nodes of blocks that are not left out, added in block order.
/// `partial` has a place for each block.
template <class Function>
double sum_over_nodes(Scheduler& scheduler, const kernels::NodeNumbering& numbering, std::span<double> partial,
                      const Function& value) {
    for_each_awake_block(scheduler, numbering, [&](int block) {
        double sum = 0;
        for (std::int32_t node = numbering.block_begin[block]; node < numbering.block_begin[block + 1]; ++node) {
            sum += value(static_cast<std::size_t>(node), 4 * static_cast<std::size_t>(node));
        }
        partial[static_cast<std::size_t>(block)] = sum;
    });
    return sum_over_awake_blocks(numbering, partial);
}

/// Whether the positions and velocities (xyz_) of all free nodes are finite.
inline bool is_finite(Scheduler& scheduler, const kernels::NodeNumbering& numbering, std::span<double> partial,
                      std::span<const double> position, std::span<const double> velocity) {
    return std::isfinite(sum_over_nodes(scheduler, numbering, partial, [&](std::size_t, std::size_t at) {
        double sum = 0;
        for (std::size_t i = at; i < at + 3; ++i) sum += std::abs(position[i]) + std::abs(velocity[i]);
        return sum;
    }));
}

/// The potential energy of weight in joules, zero at `rest`. Positions are xyz_ nodal vectors, `mass` is [node].
inline double gravity_energy(Scheduler& scheduler, const kernels::NodeNumbering& numbering, std::span<double> partial,
                             std::span<const double> mass, const std::array<double, 3>& gravity,
                             std::span<const double> position, std::span<const double> rest) {
    return -sum_over_nodes(scheduler, numbering, partial, [&](std::size_t node, std::size_t at) {
        double work = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            work += mass[node] * gravity[axis] * (position[at + axis] - rest[at + axis]);
        }
        return work;
    });
}

}  // namespace lancet::runtime
