#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "lancet/experiments/bar/problem.hpp"
#include "lancet/experiments/bar/settings.hpp"
#include "lancet/experiments/common/progress.hpp"

namespace lancet::experiments::bar {

/// The fastest of some jobs, each timed a few times for a second; for a single one, or the same twice, without that.
[[nodiscard]] Job fastest_of(const std::vector<Job>& jobs, const ProblemOptions& options, const Problem& problem,
                             Progress& progress);

/// Of the choices that `entry` has (see Entry::sequences), the fastest whose error at t = 1 s is at most
/// accurate_error_percent against the positions `reference`; for the job number `variation` of jobs_of(). Errors fall
/// along a sequence, so each is searched by bisection; where several sequences get there, their ends are timed against
/// each other. Where none does, the least wrong choice. Throws lancet::Error where a worker fails.
[[nodiscard]] Job search(const Entry& entry, const Choice& choice, std::size_t variation, const ProblemOptions& options,
                         const Problem& problem, const std::vector<double>& reference,
                         const std::filesystem::path& folder, Progress& progress);

}  // namespace lancet::experiments::bar
