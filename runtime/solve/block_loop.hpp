#pragma once

#include <vector>

#include "lancet/kernels/layout/scatter_plan.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::runtime {

/// Calls body(block) for every block, the colors of a plan one after the other: within a color no two blocks write to
/// the same place. Plans of the other strategies have one color.
template <class Body>
void for_each_color(Scheduler& scheduler, const kernels::ScatterPlan& plan, const Body& body) {
    for (const std::vector<std::int32_t>& color : plan.colors()) {
        scheduler.for_each_block(static_cast<int>(color.size()),
                                 [&](int k) { body(static_cast<int>(color[static_cast<std::size_t>(k)])); });
    }
}

}  // namespace lancet::runtime
