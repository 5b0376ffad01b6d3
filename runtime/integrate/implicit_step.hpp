#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "lancet/runtime/integrate/consistent_mass.hpp"
#include "lancet/runtime/simulate/body.hpp"
#include "lancet/runtime/solve/conjugate_gradients.hpp"

namespace lancet::runtime {

/// The moving state of a body: xyz_ nodal vectors in the internal numbering.
struct BodyMotion {
    kernels::AlignedVector<double> position;  ///< metres
    kernels::AlignedVector<double> velocity;  ///< metres per second
};

/// What acts on a body during a step.
struct BodyLoads {
    std::array<double, 3> gravity{};
    kernels::AlignedVector<double> nodal;  ///< xyz_, newtons
    double rayleigh_mass = 0;
    double rayleigh_stiffness = 0;
};

/// One step of implicit Euler, linearised once or iterated, with the energy safeguard: see DeformableBody.
template <class Real, class Accumulate>
class ImplicitStep {
  public:
    ImplicitStep(ElasticElements<Real>& elements, const OperatorDefinition& definition, const Settings& settings);

    /// Advances the motion by the settings' time step. `before_hold` are the velocities as they were before held nodes
    /// got theirs, empty if no node is held.
    StepReport advance(Scheduler& scheduler, BodyMotion& motion, const BodyLoads& loads, const ConstraintFilter& filter,
                       std::span<const double> before_hold, StepTotals& totals);

    /// Kinetic and elastic energy of a motion.
    Energies energies(Scheduler& scheduler, const BodyMotion& motion, const BodyLoads& loads,
                      std::span<const double> rest_position);
    /// Assembles the step matrix at the present positions and applies it to z (xyz_, zero at fixed nodes).
    void apply_matrix(Scheduler& scheduler, const BodyMotion& motion, const BodyLoads& loads, std::span<const Real> z,
                      std::span<Real> out);

    /// Tells that the motion was changed from outside: energies and operator are taken up anew.
    void forget() noexcept;
    void forget_energy() noexcept { energy_is_known_ = false; }
    /// Tells that rotations and gradients were renewed from outside.
    void forget_matrix() noexcept { matrix_is_known_ = false; }

    std::size_t bytes() const noexcept;
    const Operator<Real>& matrix() const noexcept { return *matrix_; }
    Preconditioner<Real>& preconditioner() const noexcept { return *preconditioner_; }

    void save(std::vector<double>& numbers) const;
    /// Reads back what save wrote, after the elements' rotations and gradients have been restored.
    void restore(Scheduler& scheduler, std::span<const double>& numbers);

  private:
    struct Residual {
        double squared_norm = 0;
    };
    class Timer;

    double step_length() const noexcept;
    bool is_linear() const noexcept { return settings_.model == ElementModel::linear; }
    void linearise(Scheduler& scheduler, const double* position, const BodyLoads& loads, bool renew);
    Residual right_hand_side(Scheduler& scheduler, const BodyMotion& motion, const BodyLoads& loads,
                             const ConstraintFilter& filter, bool at_state);
    ConjugateGradientResult solve(Scheduler& scheduler, const BodyMotion& motion, const ConstraintFilter& filter,
                                  StepReport& report);
    void newton(Scheduler& scheduler, BodyMotion& motion, const BodyLoads& loads, const ConstraintFilter& filter,
                StepReport& report, StepTotals& totals);
    void step_from_state(Scheduler& scheduler, BodyMotion& motion, const BodyLoads& loads,
                         const ConstraintFilter& filter, StepReport& report, StepTotals& totals);
    void safeguard(Scheduler& scheduler, BodyMotion& motion, const BodyLoads& loads, const ConstraintFilter& filter,
                   std::span<const double> before_hold, StepReport& report, StepTotals& totals);
    /// What the step gained in energy beyond the work of loads and holds, less what rounding explains.
    double growth(Scheduler& scheduler, const BodyMotion& motion, const BodyLoads& loads,
                  std::span<const double> before_hold);
    /// Leaves the positions that belong to `velocity` in `motion`.
    double incremental_potential(Scheduler& scheduler, BodyMotion& motion, std::span<const double> velocity,
                                 const BodyLoads& loads);
    double kinetic_energy(Scheduler& scheduler, std::span<const double> velocity);
    double elastic_energy(Scheduler& scheduler, const double* position);
    /// motion.velocity += the solution of the last solve.
    void add_change(Scheduler& scheduler, BodyMotion& motion);
    /// Goes along the solution of the last solve as far as the incremental potential falls by halving the step; false
    /// if it does not fall, up to `rounding`. `potential` is that of the motion, on entry and on exit; `move` after it.
    bool descend(Scheduler& scheduler, BodyMotion& motion, const BodyLoads& loads, double& potential, double rounding);
    /// motion.position = start + factor * velocity on all nodes.
    void move(Scheduler& scheduler, BodyMotion& motion, double factor, std::span<const double> velocity);
    /// A component of M v at a free node; value(node) is that component of v.
    template <class Value>
    double inertia(std::size_t node, const Value& value) const;
    /// Scales the velocities by `share` where no hold prescribes them.
    void slow_down(Scheduler& scheduler, BodyMotion& motion, const ConstraintFilter& filter, double share);
    bool is_finite(Scheduler& scheduler, std::span<const double> nodal);
    template <class Function>
    double sum_over_nodes(Scheduler& scheduler, const Function& value);

    ElasticElements<Real>* elements_;
    const kernels::NodeNumbering* numbering_;
    Settings settings_;
    std::vector<double> mass_;  ///< row sums, [node]
    ConsistentMass consistent_mass_;
    std::unique_ptr<Operator<Real>> matrix_;
    std::unique_ptr<Preconditioner<Real>> preconditioner_;
    ConjugateGradients<Real, Accumulate> conjugate_gradients_;
    kernels::AlignedVector<double> start_position_, start_velocity_, trial_velocity_;
    kernels::AlignedVector<Accumulate> right_hand_side_, change_;
    std::vector<double> partial_;
    std::array<double, 4> fall_{};      ///< what gravity alone adds to the velocity of a body that nothing holds
    double kinetic_ = 0, elastic_ = 0;  ///< at the end of the last step
    bool energy_is_known_ = false;
    bool matrix_is_known_ = false;
    int steps_since_renewal_ = 0;
};

}  // namespace lancet::runtime
