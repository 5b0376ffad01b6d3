#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "lancet/runtime/integrate/energy_safeguard.hpp"
#include "lancet/runtime/integrate/newmark_acceleration.hpp"
#include "lancet/runtime/integrate/step_method.hpp"

namespace lancet::runtime {

/// One step of an implicit integrator: see DeformableBody. All of them solve StepEquations, linearised once or iterated
/// by Newton's method; the midpoint rule goes on from the middle of the step to its end, Newmark's method has
/// accelerations, and implicit Euler its energy safeguard.
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
    void forget_acceleration() noexcept override;
    void forget_matrix() noexcept override { system_.forget_matrix(); }
    void change_sleepers() override;

    std::size_t bytes() const noexcept override;
    const Operator<Real>* matrix() const noexcept override { return &system_.matrix(); }
    CoarseSpace<Real>* coarse() const noexcept override { return system_.preconditioner().coarse(); }

    void save(std::vector<double>& numbers) const override;
    void restore(Scheduler& scheduler, std::span<const double>& numbers) override;

  private:
    /// What Newton's iterations of a step go by.
    struct Newton {
        double reference = 0;   ///< of the residual
        double potential = 0;   ///< incremental, where it is searched along a line
        bool is_finite = true;  ///< all right-hand sides were
    };

    /// Evaluates in the middle of the step, and goes on from there to its end.
    bool is_midpoint() const noexcept {
        return settings_.integrator == Integrator::implicit_midpoint || takes_average_stress();
    }
    bool takes_average_stress() const noexcept { return settings_.integrator == Integrator::energy_momentum; }
    bool is_at_state() const noexcept { return settings_.linearisation == Linearisation::state; }
    /// A step that is linearised at the state is linearised once.
    int iterations() const noexcept { return is_at_state() ? 1 : settings_.newton_iterations; }

    /// Keeps what the step starts from, and evaluates the forces where it is first linearised.
    void begin(Scheduler& scheduler, const StepSubject& subject, StepTotals& totals);
    /// The first linear system: matrix, right-hand side and preconditioner.
    void set_up_system(Scheduler& scheduler, const StepSubject& subject, StepTotals& totals);
    /// Takes the solution of the last solve; false where Newton's iterations end by that.
    bool accept(Scheduler& scheduler, const StepSubject& subject, bool is_first, StepReport& report,
                StepTotals& totals);
    /// Takes the solution of the first system, and goes on with Newton's iterations.
    void iterate(Scheduler& scheduler, const StepSubject& subject, StepReport& report, StepTotals& totals);
    void end(Scheduler& scheduler, const StepSubject& subject, StepReport& report, StepTotals& totals);
    /// |g (M gravity + f_ext)|, newton seconds.
    double load_norm(Scheduler& scheduler, const BodyLoads& loads);
    /// motion.velocity += the solution of the last solve.
    void add_change(Scheduler& scheduler, BodyMotion& motion);
    /// From the middle of the step to its end.
    void extrapolate(Scheduler& scheduler, BodyMotion& motion);
    /// Leaves the body at rest where the step began.
    void stop(BodyMotion& motion) noexcept;

    ElasticElements<Real>* elements_;
    const kernels::NodeNumbering* numbering_;
    Settings settings_;
    Inertia inertia_;
    StepEquations equations_;
    StepEnergy<Real> energy_;
    StepSystem<Real, Accumulate> system_;
    LineSearch<Real, Accumulate> line_search_;
    EnergySafeguard<Real, Accumulate> safeguard_;
    std::optional<NewmarkAcceleration<Real, Accumulate>> newmark_;
    std::vector<double> partial_;
    Newton newton_;
    bool is_rotated_ = false;  ///< rotations are newer than the matrix
    int steps_since_renewal_ = 0;
};

}  // namespace lancet::runtime
