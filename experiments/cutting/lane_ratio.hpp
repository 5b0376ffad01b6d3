#pragma once

#include "lancet/experiments/cutting/run.hpp"

namespace lancet::experiments::cutting {

/// What an element that is cut once costs, over one that is not cut: the Bar with every element cut through its middle,
/// by a plane in each layer of cells, against the Bar, per element. All pieces lie about the uncut element's place in
/// memory, as they do where a body is cut everywhere.
struct LaneRatio {
    double force = 0;          ///< rotation, rotated gradients, elastic force
    double product = 0;        ///< one product with the step matrix
    double both = 0;           ///< one force and one product
    double lanes = 0;          ///< parts over elements
    double nodes = 0;          ///< copies over nodes
    double edges = 0;          ///< pairs of copies that share a part, over edges
    double noise_percent = 0;  ///< of `both`, each time taken by itself: (upper - lower quartile) / median
    double force_ns = 0;       ///< of an uncut element
    double product_ns = 0;
};

/// Measured by `repetitions` of each in turn; the shortest times are compared, since whatever else runs on the machine
/// can only lengthen them. Throws CheckFailed where an element
/// is not cut once.
[[nodiscard]] LaneRatio measure_lane_ratio(const runtime::Scene& bar, const Arithmetic& arithmetic, double time_step,
                                           runtime::Scheduler& scheduler, int repetitions);

}  // namespace lancet::experiments::cutting
