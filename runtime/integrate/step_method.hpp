#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "lancet/runtime/simulate/body.hpp"
#include "lancet/runtime/solve/coarse_space.hpp"
#include "lancet/runtime/solve/constraints.hpp"
#include "lancet/runtime/solve/lanczos.hpp"
#include "lancet/runtime/solve/operator.hpp"

namespace lancet::runtime {

/// The moving state of a body: xyz_ nodal vectors in the internal numbering.
struct BodyMotion {
    kernels::AlignedVector<double> position;      ///< metres
    kernels::AlignedVector<double> velocity;      ///< metres per second
    kernels::AlignedVector<double> acceleration;  ///< m / s^2; empty for integrators that keep none
};

/// What acts on a body during a step.
struct BodyLoads {
    std::array<double, 3> gravity{};
    kernels::AlignedVector<double> nodal;  ///< xyz_, newtons
    double rayleigh_mass = 0;
    double rayleigh_stiffness = 0;
};

/// What a step changes, and what it depends on.
struct StepSubject {
    BodyMotion& motion;
    const BodyLoads& loads;
    const ConstraintFilter& filter;
    std::span<const double> before_hold;  ///< velocities before held nodes got theirs; empty if no node is held
};

/// How a body goes from one step to the next: what ImplicitStep and ExplicitStep have in common.
template <class Real>
class StepMethod {
  public:
    StepMethod() = default;
    StepMethod(const StepMethod&) = delete;
    StepMethod& operator=(const StepMethod&) = delete;
    virtual ~StepMethod() = default;

    /// One stage of a step; all of them, in their order and with the same subject, advance its motion by the settings'
    /// time step. The report and the totals are complete after the last.
    virtual void run(StepStage stage, Scheduler& scheduler, const StepSubject& subject, StepReport& report,
                     StepTotals& totals) = 0;

    /// Kinetic and elastic energy of a motion, and that of its weight, zero at `rest_position`.
    virtual Energies energies(Scheduler& scheduler, const BodyMotion& motion, const BodyLoads& loads,
                              std::span<const double> rest_position) = 0;
    /// Applies the matrix of a step's equations at the present positions to z (xyz_, zero at fixed nodes).
    virtual void apply_matrix(Scheduler& scheduler, const BodyMotion& motion, const BodyLoads& loads,
                              std::span<const Real> z, std::span<Real> out) = 0;
    /// The largest eigenvalue of M^-1 K, M lumped, over the free nodes at these positions, in 1 / s^2.
    virtual LargestEigenvalue largest_eigenvalue(Scheduler& scheduler, const double* position, double tolerance) = 0;

    /// Takes up elements and masses that have changed, after the elements themselves have. False where there is no
    /// room, which leaves the method unfit for use.
    virtual bool change(const LayoutChange& change) = 0;

    /// Tells that the motion was changed from outside: energies, operator and accelerations are taken up anew.
    virtual void forget() noexcept = 0;
    /// Tells that the velocities alone were changed.
    virtual void forget_velocity() noexcept = 0;
    /// Tells that other nodes are held than before.
    virtual void forget_acceleration() noexcept = 0;
    /// Tells that rotations and gradients were renewed from outside.
    virtual void forget_matrix() noexcept = 0;

    /// Tells that other nodes are asleep than before (NodeNumbering::sleeping), which have no velocity and no
    /// acceleration. Those that wake start without; the others keep theirs.
    virtual void change_sleepers() = 0;

    virtual std::size_t bytes() const noexcept = 0;
    /// nullptr where no system is solved.
    virtual const Operator<Real>* matrix() const noexcept = 0;
    /// nullptr where there is none.
    virtual CoarseSpace<Real>* coarse() const noexcept = 0;

    virtual void save(std::vector<double>& numbers) const = 0;
    /// Reads back what save wrote, after the elements' rotations and gradients have been restored.
    virtual void restore(Scheduler& scheduler, std::span<const double>& numbers) = 0;
};

}  // namespace lancet::runtime
