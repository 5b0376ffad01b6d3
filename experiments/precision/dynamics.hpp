#pragma once

#include <string>
#include <vector>

#include "lancet/experiments/common/progress.hpp"
#include "lancet/experiments/precision/advice.hpp"
#include "lancet/experiments/precision/choice.hpp"
#include "lancet/experiments/precision/dynamic_problem.hpp"
#include "lancet/experiments/precision/measure.hpp"
#include "lancet/experiments/precision/norms.hpp"

namespace lancet::experiments::precision {

/// What runs in time are judged by: our own double solution on the same mesh, extrapolated to a time step of zero.
struct DynamicReference {
    BoxField displacement;  ///< at the end
    EnergyForm form;
    Norms size;
    double own_percent = 0;  ///< the change that the extrapolation made, in the L2 norm: its error is less
};

[[nodiscard]] DynamicReference make_dynamic_reference(const DynamicProblem& problem, const Choice& choice,
                                                      Progress& progress);

/// All that is measured of a problem. Both must outlive the study.
[[nodiscard]] Study dynamic_study(const DynamicProblem& problem, const DynamicReference& reference,
                                  const Choice& choice);

/// One run by Lancet on the mesh of a level; throws RunFailed where it is lost, or keeps the processor busy
/// for longer than `longest_seconds`.
[[nodiscard]] Solution simulate(const DynamicProblem& problem, int level, const Setting& setting,
                                double longest_seconds);

/// The parts of the error of the fastest accurate setting (float, ten iterations a step) at the longest time step.
[[nodiscard]] BudgetLine dynamic_budget(const DynamicProblem& problem, const DynamicReference& reference,
                                        const Choice& choice, Progress& progress);

}  // namespace lancet::experiments::precision
