#pragma once

#include <cstddef>
#include <vector>

#include "lancet/runtime/integrate/step_system.hpp"

namespace lancet::runtime {

/// What Newmark's method (1959) has beside the solution of a step: accelerations, which it takes from one step to the
/// next, and a start (StepEquations) that is made of them. a_n+1 = (v_n+1 - v~) / g.
template <class Real, class Accumulate>
class NewmarkAcceleration {
  public:
    /// All but the settings must outlive it.
    NewmarkAcceleration(const Settings& settings, const kernels::NodeNumbering& numbering, const Inertia& inertia,
                        StepEquations& equations, StepSystem<Real, Accumulate>& system);

    bool is_known() const noexcept { return is_known_; }
    /// motion.acceleration = M^-1 (f - D v) where nothing is held. Overwrites the start of the step.
    void find(Scheduler& scheduler, BodyMotion& motion, const BodyLoads& loads, const ConstraintFilter& filter);
    /// Sets the start of the step, x~ and v~, from the motion.
    void begin(Scheduler& scheduler, const BodyMotion& motion);
    /// Takes the new accelerations from the velocities.
    void end(Scheduler& scheduler, BodyMotion& motion);
    /// x_n, xyz_.
    const kernels::AlignedVector<double>& old_position() const noexcept { return old_position_; }

    /// Tells that the motion, or what holds it, was changed from outside.
    void forget() noexcept { is_known_ = false; }
    std::size_t bytes() const noexcept { return kernels::heap_bytes(old_position_); }

    void save(std::vector<double>& numbers) const { numbers.push_back(is_known_ ? 1.0 : 0.0); }
    /// Reads back what save wrote, from the front of `numbers`, which it removes.
    void restore(std::span<const double>& numbers);

  private:
    const kernels::NodeNumbering* numbering_;
    const Inertia* inertia_;
    StepEquations* equations_;
    StepSystem<Real, Accumulate>* system_;
    double beta_;
    kernels::AlignedVector<double> old_position_;
    bool is_known_ = false;
};

}  // namespace lancet::runtime
