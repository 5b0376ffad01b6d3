#pragma once

#include <string>
#include <vector>

#include "lancet/experiments/common/progress.hpp"
#include "lancet/experiments/cutting/lane_ratio.hpp"
#include "lancet/experiments/cutting/row.hpp"
#include "lancet/experiments/cutting/run.hpp"

namespace lancet::experiments::cutting {

/// How things are measured.
struct Study {
    std::vector<Arithmetic> arithmetics{};
    std::vector<LaneRatio> lane_ratios{};  ///< of each
    int repetitions = 1;
    bool is_quick = false;
    runtime::Scheduler* scheduler = nullptr;
};

/// A row with the names of an arithmetic, and what its cut elements cost.
[[nodiscard]] Row start_row(const std::string& scene, const std::string& variant, const Study& study,
                            std::size_t arithmetic);
/// Counts of the body at the end of a run, mean times of its cuts, the median of its steps and their noise.
void fill(Row& row, const std::vector<std::vector<Frame>>& repetitions, const Scenario& scenario);

/// What was measured of a scenario.
struct Motion {
    std::vector<Row> runs;    ///< of the body uncut, cut with sharp fronts and with blended ones, by every arithmetic
    std::vector<Row> frames;  ///< of every step of the cut bodies' runs, by every arithmetic
};

/// Runs a scenario without its strokes and with them, in every arithmetic, repetitions interleaved, and compares with
/// the same steps converged in double.
[[nodiscard]] Motion measure_motion(const Scenario& scenario, const Study& study, Progress& progress);

}  // namespace lancet::experiments::cutting
