#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lancet/kernels/layout/node_numbering.hpp"
#include "lancet/kernels/layout/scatter_plan.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::runtime {

/// Calls body(block) for every block of a numbering that is not left out (NodeNumbering::sleeping), on the threads of
/// the scheduler.
template <class Body>
void for_each_awake_block(Scheduler& scheduler, const kernels::NodeNumbering& numbering, const Body& body) {
    if (!numbering.sleeping.are_left_out) {
        scheduler.for_each_block(numbering.blocks(), body);
        return;
    }
    const std::vector<std::int32_t>& awake = numbering.sleeping.awake_blocks;
    scheduler.for_each_block(static_cast<int>(awake.size()),
                             [&](int k) { body(static_cast<int>(awake[static_cast<std::size_t>(k)])); });
}

/// The same, the colors of a plan one after the other: within a color no two blocks write to the same place. Plans of
/// the other strategies have one color.
template <class Body>
void for_each_color(Scheduler& scheduler, const kernels::NodeNumbering& numbering, const kernels::ScatterPlan& plan,
                    const Body& body) {
    if (plan.colors().size() == 1) {
        for_each_awake_block(scheduler, numbering, body);
        return;
    }
    for (const std::vector<std::int32_t>& color : plan.colors()) {
        scheduler.for_each_block(static_cast<int>(color.size()), [&](int k) {
            const auto block = static_cast<int>(color[static_cast<std::size_t>(k)]);
            if (!numbering.sleeping.leave_out(block)) body(block);
        });
    }
}

/// The partial results of the blocks that are not left out, in block order, taken together by value = add(value,
/// partial).
template <class Add>
double over_awake_blocks(const kernels::NodeNumbering& numbering, std::span<const double> partials, const Add& add) {
    double value = 0;
    for (std::size_t block = 0; block < partials.size(); ++block) {
        if (!numbering.sleeping.leave_out(static_cast<int>(block))) value = add(value, partials[block]);
    }
    return value;
}

/// Their sum, as in sum_in_order.
inline double sum_over_awake_blocks(const kernels::NodeNumbering& numbering, std::span<const double> partials) {
    return over_awake_blocks(numbering, partials, [](double sum, double partial) { return sum + partial; });
}

/// The largest of those that are not negative.
inline double largest_of_awake_blocks(const kernels::NodeNumbering& numbering, std::span<const double> partials) {
    return over_awake_blocks(numbering, partials,
                             [](double most, double partial) { return most < partial ? partial : most; });
}

}  // namespace lancet::runtime
