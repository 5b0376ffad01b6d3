#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lancet/experiments/bar/problem.hpp"

namespace lancet::experiments::bar {

/// Root mean square over all nodes of the distance between two states, in percent of the problem's length. Positions
/// hold x, y, z of every node. Not finite where a state is not. Throws lancet::Error for states of different size.
[[nodiscard]] double error_percent(const Problem& problem, std::span<const double> positions,
                                   std::span<const double> reference);

/// The times at which errors are measured: those of 1 and 5 s that the simulation reaches and that are multiples of its
/// time step.
[[nodiscard]] std::vector<double> error_times(const Problem& problem);

/// Converged solutions; what was not computed is empty.
struct Reference {
    std::vector<double> times;                   ///< error_times(), and for each of them ...
    std::vector<std::vector<double>> positions;  ///< ... the converged step of the problem's own length
    std::vector<double> positions_t1_dt0;        ///< at t = 1 s, converged in the length of the step too
    std::vector<double> positions_rest;          ///< the static equilibrium
};

/// Errors of one run in percent of the length; missing where there is no reference.
struct Errors {
    std::optional<double> t1, t5, t1_dt0, rest;
};

/// Errors of snapshots at Reference::times; `rest` is empty or the positions at rest.
[[nodiscard]] Errors errors_of(const Problem& problem, const Reference& reference,
                               const std::vector<std::vector<double>>& snapshots, std::span<const double> rest);

}  // namespace lancet::experiments::bar
