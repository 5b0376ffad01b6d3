#pragma once

#include <span>
#include <vector>

#include "lancet/runtime/integrate/step_equations.hpp"

namespace lancet::runtime {

/// Energies of a body, and what the energy safeguard of a step is measured by. Nodal vectors are xyz_.
template <class Real>
class StepEnergy {
  public:
    /// Both must outlive it.
    StepEnergy(ElasticElements<Real>& elements, const Inertia& inertia);

    /// v M v / 2 in joules.
    double kinetic(Scheduler& scheduler, std::span<const double> velocity);
    /// In joules, with the rotations taken up at `position`.
    double elastic(Scheduler& scheduler, const double* position);

    /// The function of v whose minimum solves the step where there is no damping proportional to the stiffness:
    ///     |v - v~|_M^2 / 2 + g alpha |v|_M^2 / 2 + (g / c) W(x~ + c v) - (g f_ext + i) v.
    /// `position` is x~ + c v.
    double incremental_potential(Scheduler& scheduler, const StepEquations& step, const BodyLoads& loads,
                                 std::span<const double> position, std::span<const double> velocity);

    /// Kinetic and elastic energy in joules.
    struct Inner {
        double kinetic = 0;
        double elastic = 0;
        double sum() const noexcept { return kinetic + elastic; }
    };
    /// What a step of implicit Euler gained in energy beyond the work of loads and holds, less what rounding explains;
    /// infinite for energies that are not finite. `before_hold` are the velocities as they were before held nodes got
    /// theirs, empty if no node is held. `energy` is that at the start, on exit that of the motion.
    double growth(Scheduler& scheduler, const StepEquations& step, const BodyLoads& loads, const BodyMotion& motion,
                  std::span<const double> before_hold, Inner& energy);

    std::size_t bytes() const noexcept { return kernels::heap_bytes(partial_); }

  private:
    bool is_linear() const noexcept { return elements_->law().model == ElementModel::linear; }
    template <class Function>
    double sum_over_nodes(Scheduler& scheduler, const Function& value);

    ElasticElements<Real>* elements_;
    const Inertia* inertia_;
    std::vector<double> partial_;
};

}  // namespace lancet::runtime
