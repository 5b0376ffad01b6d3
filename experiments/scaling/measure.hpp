#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "lancet/experiments/common/progress.hpp"
#include "lancet/experiments/scaling/plan.hpp"
#include "lancet/experiments/scaling/report.hpp"

namespace lancet::experiments::scaling {

/// The reports of all repetitions of every job of a plan, [job][repetition].
using Measurement = std::vector<std::vector<Report>>;

/// Runs every job so many times, interleaved round robin so that a disturbance of the machine meets all of them alike,
/// each run in a process of its own: the worker scaling_worker in `folder`. Then come further rounds, at most
/// settings.extra_rounds, of the jobs that are not quiet yet. Converged solutions come from the settings'
/// cache, or are computed first and kept there. Throws lancet::Error where a worker fails.
[[nodiscard]] Measurement measure(const Plan& plan, const ScalingSettings& settings,
                                  const std::filesystem::path& folder, Progress& progress);

/// The shortest spin of all runs, s; see Load.
[[nodiscard]] double shortest_spin(const Measurement& measurement);

/// Whether the threads of a run were more than the cores that it could use.
[[nodiscard]] bool is_oversubscribed(const Report& report);

/// What each repetition of a job has lost; see lost_share().
[[nodiscard]] std::vector<double> lost_shares(std::span<const Report> reports, double shortest_spin);

}  // namespace lancet::experiments::scaling
