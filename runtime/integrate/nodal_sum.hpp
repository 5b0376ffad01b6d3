#pragma once

#include <cstddef>
#include <span>

#include "lancet/kernels/layout/node_numbering.hpp"
#include "lancet/runtime/schedule/ordered_sum.hpp"

namespace lancet::runtime {

/// The sum of value(node, 4 * node) over the free nodes, added in block order. `partial` has a place for each block.
template <class Function>
double sum_over_nodes(Scheduler& scheduler, const kernels::NodeNumbering& numbering, std::span<double> partial,
                      const Function& value) {
    return ordered_sum(scheduler, partial, [&](int block) {
        double sum = 0;
        for (std::int32_t node = numbering.block_begin[block]; node < numbering.block_begin[block + 1]; ++node) {
            sum += value(static_cast<std::size_t>(node), 4 * static_cast<std::size_t>(node));
        }
        return sum;
    });
}

}  // namespace lancet::runtime
