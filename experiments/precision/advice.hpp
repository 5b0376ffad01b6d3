#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lancet/experiments/precision/run.hpp"

namespace lancet::experiments::precision {

/// What to use for an error of at most so much.
struct Advice {
    std::string problem, variant;
    double target_percent = 0;
    /// The fastest row whose judged error is at most the target; where there is none, the fastest of the most accurate
    /// ones (see worthwhile_gain).
    std::size_t row = 0;
    bool reached = false;
};

/// The errors that advice is given for, in percent.
inline constexpr std::array advice_targets{10.0, 1.0, 0.1, 0.01};

/// For every problem and variant among the rows, in their order, and every target.
[[nodiscard]] std::vector<Advice> give_advice(std::span<const Row> rows);

/// The error of a problem in a fast setting, by what causes it: relative L2 norms in percent. Parts are differences of
/// solutions that differ in one thing; what a problem does not have is missing.
struct BudgetLine {
    std::string problem, variant;
    std::string setting;
    std::optional<double> time_step;      ///< of steps solved exactly
    std::optional<double> linearisation;  ///< once a step instead of until it is solved
    std::optional<double> mesh;
    std::optional<double> solve;   ///< conjugate gradients that end early
    std::optional<double> scalar;  ///< float instead of double
    double total = 0;              ///< without the mesh's share where `total_has_mesh` is not set
    bool total_has_mesh = true;

    /// The largest part: "time step", "linearisation", "mesh", "linear solve" or "float"; "nothing" without parts.
    [[nodiscard]] std::string dominating() const;
};

}  // namespace lancet::experiments::precision
