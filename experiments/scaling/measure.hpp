#pragma once

#include <filesystem>
#include <vector>

#include "lancet/experiments/common/progress.hpp"
#include "lancet/experiments/scaling/plan.hpp"
#include "lancet/experiments/scaling/report.hpp"

namespace lancet::experiments::scaling {

/// The reports of all repetitions of every job of a plan, [job][repetition].
using Measurement = std::vector<std::vector<Report>>;

/// Runs every job so many times, interleaved round robin so that a disturbance of the machine meets all of them alike,
/// each run in a process of its own: the worker scaling_worker in `folder`. Converged solutions come from the settings'
/// cache, or are computed first and kept there. Throws lancet::Error where a worker fails.
[[nodiscard]] Measurement measure(const Plan& plan, const ScalingSettings& settings,
                                  const std::filesystem::path& folder, Progress& progress);

}  // namespace lancet::experiments::scaling
