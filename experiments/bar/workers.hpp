#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lancet/experiments/bar/problem.hpp"
#include "lancet/experiments/bar/settings.hpp"
#include "lancet/experiments/bar/worker.hpp"
#include "lancet/experiments/common/progress.hpp"

namespace lancet::experiments::bar {

/// What one job gave.
struct JobResult {
    std::vector<WorkerReport> reports;           ///< one per repetition
    std::vector<std::vector<double>> snapshots;  ///< of the first repetition, one per time asked for
};

/// Runs a worker once. Positions at `snapshot_times` go to `snapshots` (nothing is asked for when there are no times).
/// Throws lancet::Error when the worker fails or prints something else than its report.
WorkerReport run_worker(const Job& job, const ProblemOptions& problem, const std::vector<double>& snapshot_times,
                        std::size_t nodes, std::vector<std::vector<double>>& snapshots);

/// Runs every job `repetitions` times, interleaved round robin so that a disturbance of the machine meets all of them
/// alike, each run in a process of its own. The first round writes the snapshots.
[[nodiscard]] std::vector<JobResult> run_jobs(const std::vector<Job>& jobs, int repetitions,
                                              const ProblemOptions& problem, const std::vector<double>& snapshot_times,
                                              std::size_t nodes, Progress& progress);

}  // namespace lancet::experiments::bar
