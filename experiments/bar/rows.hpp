#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lancet/experiments/bar/errors.hpp"
#include "lancet/experiments/bar/settings.hpp"
#include "lancet/experiments/bar/worker.hpp"
#include "lancet/experiments/common/table.hpp"

namespace lancet::experiments::bar {

/// One row of the result: the medians over the repetitions of a job. Seconds are wall-clock seconds of all steps.
struct Row {
    Job job;
    WorkerReport report;  ///< of the repetition with the median total (the lower one of two in the middle)
    double seconds = 0, seconds_minimum = 0, seconds_maximum = 0;
    double simulated_seconds = 0;
    Errors errors;
    std::optional<double> speedup_over_eigen, speedup_over_thesis, speedup_over_one_thread;
};

/// The row of a job from the reports of its repetitions. Throws lancet::Error when there are none.
[[nodiscard]] Row make_row(const Job& job, const std::vector<WorkerReport>& reports, const Errors& errors,
                           double time_step);

/// Fills in the speed-ups: over the baselines in the same setting and scalar type with one thread, and over the row
/// that differs in nothing but having one thread (or the serial scheduler, where threads = 1 has that name).
void add_speedups(std::vector<Row>& rows);

/// The rows as a table for printing, CSV and JSON.
[[nodiscard]] Table make_table(std::span<const Row> rows);

}  // namespace lancet::experiments::bar
