#pragma once

#include <vector>

#include "lancet/experiments/common/progress.hpp"
#include "lancet/experiments/cutting/motion.hpp"

namespace lancet::experiments::cutting {

/// What a step costs with 0, 1, 2, 5, 10 and 30 % of the elements cut: the Bar with slots from above, as deep as three
/// quarters of it, made by one cut at rest. Every step takes ten iterations of conjugate gradients, so that times
/// compare. Repetitions are interleaved.
[[nodiscard]] std::vector<Row> measure_cost(const Study& study, Progress& progress);

}  // namespace lancet::experiments::cutting
