#pragma once

#include <span>

#include "lancet/runtime/integrate/inertia.hpp"
#include "lancet/runtime/integrate/step_method.hpp"

namespace lancet::runtime {

/// What an implicit integrator solves in a step of h seconds for the velocity v:
///     x = x~ + c v,   M (v - v~) = g (f(x) - D v) + i.
/// Implicit Euler: x~ = x_n, v~ = v_n, c = g = h. The midpoint rule: the same with c = g = h / 2 up to the middle of
/// the step, from where the state is extrapolated. Newmark (1959): c = beta h / gamma, g = gamma h, v~ = v_n + e a_n
/// with e = h (1 - gamma), x~ = x_n + h v_n + h^2 (1/2 - beta) a_n - c v~.
///
/// Held nodes have their velocity of the step from its start. With a consistent mass their acceleration a_i, taken as
/// the change of that velocity over the step's length, acts on their neighbours by -M_fi a_i: of first order in h.
class StepEquations {
  public:
    /// `numbering` and `inertia` must outlive it.
    StepEquations(const Settings& settings, const kernels::NodeNumbering& numbering, const Inertia& inertia);

    double step_length() const noexcept { return step_length_; }          ///< h
    double position_length() const noexcept { return position_length_; }  ///< c
    double momentum_length() const noexcept { return momentum_length_; }  ///< g
    /// e: what the acceleration at the start has changed the velocity by already, for an acceleration of 1.
    double early_length() const noexcept { return early_length_; }

    /// x~ and v~, xyz_.
    kernels::AlignedVector<double>& position() noexcept { return position_; }
    const kernels::AlignedVector<double>& position() const noexcept { return position_; }
    kernels::AlignedVector<double>& velocity() noexcept { return velocity_; }
    const kernels::AlignedVector<double>& velocity() const noexcept { return velocity_; }

    /// i, xyz_ in newton seconds; empty for none.
    std::span<const double> impulse() const noexcept {
        return has_impulse_ ? std::span<const double>(impulse_) : std::span<const double>();
    }
    /// i = -(g / h) M (v - before_hold): what the change of velocity of held nodes does to their neighbours. None where
    /// `before_hold` is empty, or the mass is lumped.
    void set_impulse(Scheduler& scheduler, std::span<const double> velocity, std::span<const double> before_hold);

    /// position = x~ + length * velocity on all free nodes.
    void move(Scheduler& scheduler, std::span<double> position, double length, std::span<const double> velocity) const;

    std::size_t bytes() const noexcept;

  private:
    const kernels::NodeNumbering* numbering_;
    const Inertia* inertia_;
    double step_length_;
    double position_length_;
    double momentum_length_;
    double early_length_;
    kernels::AlignedVector<double> position_, velocity_;
    kernels::AlignedVector<double> impulse_;  ///< empty for a lumped mass
    bool has_impulse_ = false;
};

}  // namespace lancet::runtime
