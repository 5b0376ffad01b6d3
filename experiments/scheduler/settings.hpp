#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lancet/experiments/common/options.hpp"
#include "lancet/experiments/scheduler/worker.hpp"

namespace lancet::experiments::scheduler {

/// What the user asked for, with the experiment's defaults filled in.
struct SchedulerSettings {
    SharedOptions shared;
    std::vector<int> elements;  ///< of the bars
    std::vector<int> threads;
    std::vector<runtime::SchedulerKind> kinds;
    int repetitions = 0;  ///< processes for each row
    runtime::Settings body{};
    /// Where this process is a worker: what it measures.
    std::optional<WorkerJob> work;
};

/// The job for a bar: cells, and as many runs and steps as a moderate time allows.
WorkerJob job_for(int elements, const SchedulerSettings& settings);

/// Parses the command line; nothing when --help was printed. Throws lancet::Error for what makes no sense.
[[nodiscard]] std::optional<SchedulerSettings> parse_settings(int argc, const char* const* argv);

/// The command line, without the program, that makes a worker measure this.
[[nodiscard]] std::vector<std::string> worker_arguments(int elements, runtime::SchedulerKind kind, int threads,
                                                        const SchedulerSettings& settings);

}  // namespace lancet::experiments::scheduler
