#pragma once

#include <memory>
#include <optional>
#include <string>

#include "lancet/experiments/common/progress.hpp"
#include "lancet/experiments/precision/choice.hpp"
#include "lancet/experiments/precision/measure.hpp"
#include "lancet/experiments/precision/norms.hpp"
#include "lancet/experiments/precision/static_problem.hpp"
#include "lancet/runtime/simulate/equilibrium.hpp"

namespace lancet::experiments::precision {

/// What static runs are judged by: our own converged double solution on a mesh one level finer than any that is
/// measured, with Richardson's correction from that and the next coarser one (for the norms), and published
/// displacements (for the quantity of interest).
struct StaticReference {
    int level = 0;
    BoxField displacement;
    EnergyForm form;
    Norms size;                ///< of the displacement: errors are relative to it
    double own_percent = 0;    ///< the change that the correction made, in the L2 norm
    Point tip{};               ///< on the mesh of the reference, without the correction
    Point tip_extrapolated{};  ///< with it
};

/// Levels that are measured; the reference is on the next one.
[[nodiscard]] int measured_levels(const StaticProblem& problem, bool quick);

[[nodiscard]] StaticReference make_static_reference(const StaticProblem& problem, const Choice& choice,
                                                    Progress& progress);

/// Errors of positions on the mesh of a level.
[[nodiscard]] Errors judge_static(const StaticProblem& problem, const StaticReference& reference,
                                  const std::array<int, 3>& cells, const std::vector<Point>& positions);

/// All that is measured of a problem. Both must outlive the study.
[[nodiscard]] Study static_study(const StaticProblem& problem, const StaticReference& reference, const Choice& choice);

/// One equilibrium by Lancet; throws RunFailed where the full load is not reached.
[[nodiscard]] Solution find_static(const StaticProblem& problem, int level, const Setting& setting);

/// The parts of the error of a fast setting on the finest measured mesh, in the L2 norm.
struct StaticBudget {
    std::string setting;
    double mesh = 0, solve = 0, scalar = 0, total = 0;  ///< percent
};
[[nodiscard]] StaticBudget static_budget(const StaticProblem& problem, const StaticReference& reference,
                                         const Choice& choice, Progress& progress);

/// Whether the published displacement is met by the extrapolated one: the largest difference in percent of its length.
[[nodiscard]] double published_difference_percent(const StaticProblem& problem, const Point& tip);

}  // namespace lancet::experiments::precision
