#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "lancet/runtime/integrate/inertia.hpp"
#include "lancet/runtime/integrate/step_energy.hpp"
#include "lancet/runtime/integrate/step_method.hpp"
#include "lancet/runtime/solve/conjugate_gradients.hpp"

namespace lancet::runtime {

/// One step of an implicit integrator, linearised once or iterated, and implicit Euler's energy safeguard: see
/// DeformableBody. All of them solve
///     x = x~ + c v,   M (v - v~) = g (f(x) - D v)
/// for v, with the matrix M + g D + g c K. Implicit Euler: x~ = x_n, v~ = v_n, c = g = h. The midpoint rule: the same
/// with c = g = h / 2 up to the middle of the step, from where the state is extrapolated. Newmark (1959): c = beta h /
/// gamma, g = gamma h, v~ = v_n + h (1 - gamma) a_n, x~ = x_n + h v_n + h^2 (1/2 - beta) a_n - c v~, and
/// a_n+1 = (v_n+1 - v~) / g.
///
/// Held nodes have their velocity of the step from its start. With a consistent mass their acceleration a_i, taken as
/// the change of that velocity over the step's length, acts on their neighbours by -M_fi a_i: of first order in h.
template <class Real, class Accumulate>
class ImplicitStep final : public StepMethod<Real> {
  public:
    ImplicitStep(ElasticElements<Real>& elements, const OperatorDefinition& definition, const Settings& settings);

    void run(StepStage stage, Scheduler& scheduler, const StepSubject& subject, StepReport& report,
             StepTotals& totals) override;
    Energies energies(Scheduler& scheduler, const BodyMotion& motion, const BodyLoads& loads,
                      std::span<const double> rest_position) override;
    void apply_matrix(Scheduler& scheduler, const BodyMotion& motion, const BodyLoads& loads, std::span<const Real> z,
                      std::span<Real> out) override;
    LargestEigenvalue largest_eigenvalue(Scheduler& scheduler, const double* position, double tolerance) override;

    bool change(const LayoutChange& change) override;

    void forget() noexcept override;
    void forget_velocity() noexcept override;
    void forget_acceleration() noexcept override { acceleration_is_known_ = false; }
    void forget_matrix() noexcept override { matrix_is_known_ = false; }

    std::size_t bytes() const noexcept override;
    const Operator<Real>* matrix() const noexcept override { return matrix_.get(); }
    CoarseSpace<Real>* coarse() const noexcept override { return preconditioner_->coarse(); }

    void save(std::vector<double>& numbers) const override;
    void restore(Scheduler& scheduler, std::span<const double>& numbers) override;

  private:
    struct Residual {
        double squared_norm = 0;
    };
    /// What Newton's iterations of a step go by.
    struct Newton {
        double reference = 0;   ///< of the residual
        double potential = 0;   ///< incremental, where it is searched along a line
        bool is_finite = true;  ///< all right-hand sides were
    };
    class Timer;

    /// How the right-hand side is formed.
    struct Linearised {
        bool at_state;    ///< at x_n instead of the prediction
        bool falls_free;  ///< take the known fall of a body that nothing holds out of it, into fall_
    };

    /// c: what positions move by, for a velocity of 1.
    double position_length() const noexcept;
    /// g: what forces act for.
    double momentum_length() const noexcept;
    bool is_newmark() const noexcept { return settings_.integrator == Integrator::newmark; }
    /// Evaluates in the middle of the step, and goes on from there to its end.
    bool is_midpoint() const noexcept {
        return settings_.integrator == Integrator::implicit_midpoint || takes_average_stress();
    }
    bool takes_average_stress() const noexcept { return settings_.integrator == Integrator::energy_momentum; }
    /// motion.acceleration = M^-1 (f - D v) where nothing is held.
    void find_acceleration(Scheduler& scheduler, BodyMotion& motion, const BodyLoads& loads,
                           const ConstraintFilter& filter);
    /// start_position_ = x~, start_velocity_ = v~.
    void begin_newmark(Scheduler& scheduler, const BodyMotion& motion);
    /// Takes the new accelerations from the velocities.
    void end_newmark(Scheduler& scheduler, BodyMotion& motion);
    bool is_linear() const noexcept { return settings_.model == ElementModel::linear; }
    bool is_at_state() const noexcept { return settings_.linearisation == Linearisation::state; }
    /// A step that is linearised at the state is linearised once.
    int iterations() const noexcept { return is_at_state() ? 1 : settings_.newton_iterations; }

    /// Keeps what the step starts from, and evaluates the forces where it is first linearised.
    void begin(Scheduler& scheduler, const StepSubject& subject, StepTotals& totals);
    /// Forces, and where they have changed or `renew` asks for it, rotations; returns whether rotations are new.
    bool evaluate(Scheduler& scheduler, const double* position, bool renew);
    /// The matrix, unless it is as it was.
    void assemble(Scheduler& scheduler, const BodyLoads& loads, bool rotated);
    void linearise(Scheduler& scheduler, const double* position, const BodyLoads& loads, bool renew);
    /// The preconditioner, unless the matrix is as it was.
    void refresh(Scheduler& scheduler, const BodyMotion& motion);
    /// The first linear system: matrix, right-hand side and preconditioner.
    void set_up_system(Scheduler& scheduler, const StepSubject& subject, StepTotals& totals);
    /// Takes the solution of the last solve; false where Newton's iterations end by that.
    bool accept(Scheduler& scheduler, const StepSubject& subject, bool is_first, StepReport& report,
                StepTotals& totals);
    /// Takes the solution of the first system, and goes on with Newton's iterations.
    void iterate(Scheduler& scheduler, const StepSubject& subject, StepReport& report, StepTotals& totals);
    void end(Scheduler& scheduler, const StepSubject& subject, StepReport& report, StepTotals& totals);
    Residual right_hand_side(Scheduler& scheduler, const BodyMotion& motion, const BodyLoads& loads,
                             const ConstraintFilter& filter, const Linearised& how);
    ConjugateGradientResult solve(Scheduler& scheduler, const BodyMotion& motion, const ConstraintFilter& filter,
                                  StepReport& report);
    void safeguard(Scheduler& scheduler, BodyMotion& motion, const BodyLoads& loads, const ConstraintFilter& filter,
                   std::span<const double> before_hold, StepReport& report, StepTotals& totals);
    typename StepEnergy<Real>::Step step_under(const BodyLoads& loads) const noexcept;
    /// Leaves the positions that belong to `velocity` in `motion`.
    double incremental_potential(Scheduler& scheduler, BodyMotion& motion, std::span<const double> velocity,
                                 const BodyLoads& loads);
    /// motion.velocity += the solution of the last solve.
    void add_change(Scheduler& scheduler, BodyMotion& motion);
    /// Goes along the solution of the last solve as far as the incremental potential falls by halving the step; false
    /// if it does not fall, up to `rounding`. `potential` is that of the motion, on entry and on exit; `move` after it.
    bool descend(Scheduler& scheduler, BodyMotion& motion, const BodyLoads& loads, double& potential, double rounding);
    /// motion.position = start + factor * velocity on all nodes.
    void move(Scheduler& scheduler, BodyMotion& motion, double factor, std::span<const double> velocity);
    /// The mean velocity at the end of a step of implicit Euler of a body that nothing holds, from its momentum; zero
    /// for one that something holds.
    std::array<double, 4> free_velocity(Scheduler& scheduler, const BodyLoads& loads, const ConstraintFilter& filter);
    /// v = share v + (1 - share) limit where no hold prescribes it.
    void slow_down(Scheduler& scheduler, BodyMotion& motion, const ConstraintFilter& filter, double share,
                   const std::array<double, 4>& limit);
    /// held_impulse_ = -(g / h) M (v - v_before): what the change of velocity of held nodes does to their neighbours.
    void find_held_impulse(Scheduler& scheduler, const BodyMotion& motion, std::span<const double> before_hold);
    bool is_finite(Scheduler& scheduler, const BodyMotion& motion);
    /// Leaves the body at rest where the step began.
    void stop(BodyMotion& motion) noexcept;
    template <class Function>
    double sum_over_nodes(Scheduler& scheduler, const Function& value);

    ElasticElements<Real>* elements_;
    const kernels::NodeNumbering* numbering_;
    Settings settings_;
    Inertia inertia_;
    StepEnergy<Real> energy_;
    std::unique_ptr<Operator<Real>> matrix_;
    std::unique_ptr<Preconditioner<Real>> preconditioner_;
    ConjugateGradients<Real, Accumulate> conjugate_gradients_;
    kernels::AlignedVector<double> old_position_;                     ///< x_n, kept where x~ is another
    kernels::AlignedVector<double> start_position_, start_velocity_;  ///< x~ and v~
    kernels::AlignedVector<double> trial_velocity_;
    kernels::AlignedVector<double> held_impulse_;  ///< see find_held_impulse; empty for a lumped mass
    bool has_held_impulse_ = false;
    kernels::AlignedVector<Accumulate> right_hand_side_, change_;
    std::vector<double> partial_;
    std::array<double, 4> fall_{};  ///< what gravity alone adds to the velocity of a body that nothing holds
    typename StepEnergy<Real>::Inner inner_energy_;  ///< at the end of the last step
    Newton newton_;
    bool is_rotated_ = false;  ///< rotations are newer than the matrix
    bool energy_is_known_ = false;
    bool matrix_is_known_ = false;
    bool acceleration_is_known_ = false;
    int steps_since_renewal_ = 0;
};

}  // namespace lancet::runtime
