#pragma once

#include <vector>

#include "lancet/runtime/integrate/step_method.hpp"

namespace lancet::runtime {

/// One step of an explicit integrator with a lumped mass M: one evaluation of the forces, no system of equations.
///
/// Symplectic Euler: v_n+1 = v_n + h a, x_n+1 = x_n + h v_n+1, with a = M^-1 f(x_n) - alpha v_n+1.
/// Central differences, in the form of velocity Verlet: v = v_n + h/2 a_n, x_n+1 = x_n + h v, v_n+1 = v + h/2 a_n+1,
/// with a_n+1 = M^-1 f(x_n+1) - alpha v_n+1. Both take mass-proportional damping at the end of the step, which is
/// linear in v_n+1 and solved for; so it does not shorten the critical step. (Hughes 2000, chapter 9.)
///
/// Held components get the velocity that brings them to their targets, and no acceleration.
template <class Real>
class ExplicitStep final : public StepMethod<Real> {
  public:
    /// - nodal_mass: [internal node], kilograms; a node without mass keeps its velocity
    /// `elements` must outlive it; their layout is one that a matrix-free product reads.
    ExplicitStep(ElasticElements<Real>& elements, std::vector<double> nodal_mass, const Settings& settings);

    /// All is done in the first stage: there is no system to be solved.
    void run(StepStage stage, Scheduler& scheduler, const StepSubject& subject, StepReport& report,
             StepTotals& totals) override;
    Energies energies(Scheduler& scheduler, const BodyMotion& motion, const BodyLoads& loads,
                      std::span<const double> rest_position) override;
    /// M (1 + h alpha) for symplectic Euler, M (1 + h alpha / 2) for central differences.
    void apply_matrix(Scheduler& scheduler, const BodyMotion& motion, const BodyLoads& loads, std::span<const Real> z,
                      std::span<Real> out) override;
    LargestEigenvalue largest_eigenvalue(Scheduler& scheduler, const double* position, double tolerance) override;

    bool change(const LayoutChange& change) override;

    void forget() noexcept override { acceleration_is_known_ = false; }
    void forget_velocity() noexcept override { acceleration_is_known_ = false; }
    void forget_acceleration() noexcept override { acceleration_is_known_ = false; }
    void forget_matrix() noexcept override {}
    void change_sleepers() override {}

    std::size_t bytes() const noexcept override;
    const Operator<Real>* matrix() const noexcept override { return nullptr; }
    CoarseSpace<Real>* coarse() const noexcept override { return nullptr; }

    void save(std::vector<double>& numbers) const override;
    void restore(Scheduler& scheduler, std::span<const double>& numbers) override;

  private:
    bool is_linear() const noexcept { return settings_.model == ElementModel::linear; }
    /// What the damped inertia is divided by in a step.
    double damping_divisor(const BodyLoads& loads) const noexcept;
    /// motion.acceleration = (M^-1 f(x) - alpha v) / divisor where nothing is held, else 0.
    void accelerate(Scheduler& scheduler, BodyMotion& motion, const BodyLoads& loads, const ConstraintFilter& filter,
                    double divisor);
    /// motion.velocity += length * acceleration; false if a velocity is not finite then.
    bool kick(Scheduler& scheduler, BodyMotion& motion, double length);
    /// motion.position += h * velocity.
    void drift(Scheduler& scheduler, BodyMotion& motion);
    /// False if no finite state was found.
    bool take_step(Scheduler& scheduler, BodyMotion& motion, const BodyLoads& loads, const ConstraintFilter& filter,
                   StepTotals& totals);

    ElasticElements<Real>* elements_;
    const kernels::NodeNumbering* numbering_;
    Settings settings_;
    std::vector<double> mass_;  ///< [node]
    std::vector<double> partial_;
    bool acceleration_is_known_ = false;
};

}  // namespace lancet::runtime
