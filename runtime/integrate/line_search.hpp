#pragma once

#include <span>

#include "lancet/runtime/integrate/step_energy.hpp"
#include "lancet/runtime/integrate/step_system.hpp"

namespace lancet::runtime {

/// Goes along a change of velocity as far as the incremental potential of a step falls.
template <class Real, class Accumulate>
class LineSearch {
  public:
    /// Both must outlive it.
    LineSearch(StepEnergy<Real>& energy, const StepEquations& equations);

    /// StepEnergy::incremental_potential of `velocity`. Leaves the positions that belong to it in `motion`.
    double potential(Scheduler& scheduler, BodyMotion& motion, std::span<const double> velocity,
                     const BodyLoads& loads);
    /// Adds as much of `change` to motion.velocity as lets the potential fall, by halving it; false if it does not
    /// fall, up to `rounding`. `potential` is that of the motion, on entry and on exit. Leaves the positions of the
    /// last trial in `motion`: they are to be moved after it.
    bool descend(Scheduler& scheduler, BodyMotion& motion, const VelocityChange<Accumulate>& change,
                 const BodyLoads& loads, double& potential, double rounding);

    std::size_t bytes() const noexcept { return kernels::heap_bytes(trial_velocity_); }

  private:
    StepEnergy<Real>* energy_;
    const StepEquations* equations_;
    kernels::AlignedVector<double> trial_velocity_;
};

}  // namespace lancet::runtime
