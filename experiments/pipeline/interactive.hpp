#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lancet/experiments/common/progress.hpp"
#include "lancet/experiments/common/table.hpp"
#include "lancet/experiments/pipeline/device.hpp"
#include "lancet/experiments/pipeline/settings.hpp"
#include "lancet/experiments/pipeline/task_times.hpp"

namespace lancet::experiments::pipeline {

/// How a scene went.
struct Interactive {
    std::size_t elements = 0;
    std::int64_t steps = 0;
    std::int64_t late_steps = 0;  ///< that ended after the time at which the next was due
    double seconds = 0;           ///< on the clock
    std::vector<double> step_seconds;
    std::vector<TaskTimes::Task> tasks;
    std::int64_t collisions = 0;
    runtime::FrameStatistics frames;
    std::vector<double> picture_seconds;
    std::vector<double> frame_latency;  ///< s, from the hand to the end of the picture
    runtime::CutStatistics cuts;
    DeviceReport device;
    std::int64_t lost_steps = 0;  ///< of bodies: no finite state was found
    bool is_finite = true;
    std::string fingerprint;      ///< of the last positions
    std::size_t events_lost = 0;  ///< that had no place in the trace
};

/// Runs the scene of the settings. Throws lancet::Error for files that cannot be read or written.
[[nodiscard]] Interactive run_interactive(const PipelineSettings& settings, Progress& progress);

/// The rates asked for and held, deadlines and latencies.
[[nodiscard]] Table rate_table(const Interactive& run, const PipelineSettings& settings);
/// How long tasks took.
[[nodiscard]] Table task_table(const Interactive& run);

}  // namespace lancet::experiments::pipeline
