#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lancet/experiments/bar/errors.hpp"
#include "lancet/experiments/bar/problem.hpp"
#include "lancet/experiments/common/hash.hpp"
#include "lancet/experiments/common/progress.hpp"

namespace lancet::experiments::bar {

/// Which converged solutions to compute; each costs minutes on the Bar, once.
struct ReferenceChoice {
    bool step_length = true;  ///< Reference::positions_t1_dt0
    bool rest = true;         ///< Reference::positions_rest
};

/// The converged solutions of a problem, from files in `cache` where they are there, otherwise computed by the worker
/// bar_eigen in `folder` (double, every implicit Euler step solved to 1e-8 of the load) and stored there. What is
/// converged in the step length comes from Richardson extrapolation of an eighth and a sixteenth of the step. Throws
/// lancet::Error where a solution is not found.
[[nodiscard]] Reference make_reference(const ProblemOptions& options, const Problem& problem,
                                       const ReferenceChoice& choice, const std::filesystem::path& folder,
                                       const std::filesystem::path& cache, Progress& progress);

/// The options with which Lancet's workers solve every step to 1e-8 of the load, in double.
[[nodiscard]] std::vector<std::string> converged_arguments();

/// Adds all that a converged solution of `problem` depends on, but for the times it is asked at.
void add_to(Hash& hash, const Problem& problem);

/// Where references are kept by default: lancet/bar below $XDG_CACHE_HOME or $HOME/.cache.
[[nodiscard]] std::filesystem::path default_cache();

/// The same problem with mass damping that brings it to rest, twice the frequency of a pendulum of its length, for long
/// enough that nothing of the motion is left: how a method finds the static equilibrium.
[[nodiscard]] ProblemOptions to_rest(const ProblemOptions& options, const Problem& problem);

}  // namespace lancet::experiments::bar
