#pragma once

#include "lancet/experiments/stability/case.hpp"
#include "lancet/runtime/simulate/equilibrium.hpp"

namespace lancet::experiments::stability {

/// The library's settings for a variant: the interactive defaults, with what the variant says. For an explicit one,
/// the time step is 0.95 of a critical one of `uncut`; else it is `time_step`, in seconds.
runtime::Settings settings_of(const Variant& variant, const runtime::Scene& uncut, runtime::Scheduler& scheduler,
                              double time_step);

/// Those of a static solution.
runtime::EquilibriumSettings equilibrium_settings_of(const Variant& variant);

/// Every model, scalar and operator: implicit with row sums and with fraction lumping, and explicit with the latter by
/// both critical steps.
std::vector<Variant> all_dynamics();

/// Each variant with sharp fronts, and with blended ones.
std::vector<Variant> with_both_fronts(const std::vector<Variant>& variants);

}  // namespace lancet::experiments::stability
