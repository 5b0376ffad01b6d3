#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "lancet/runtime/schedule/scheduler.hpp"
#include "lancet/runtime/simulate/body_change.hpp"
#include "lancet/runtime/simulate/scene.hpp"
#include "lancet/runtime/simulate/settings.hpp"

namespace lancet::runtime {

using mesh::Point;

/// What a step consists of, in this order.
enum class StepStage {
    forces,  ///< holds and prediction; rotations and forces. Explicit integrators do all here
    matrix,  ///< and right-hand side of the first linear system; what has not changed is kept
    solve,   ///< conjugate gradients on it
    update   ///< the new state; further iterations and repetitions, where there are any
};
inline constexpr std::array step_stages{StepStage::forces, StepStage::matrix, StepStage::solve, StepStage::update};
/// "forces", "matrix", "solve" or "update".
std::string_view to_string(StepStage stage) noexcept;

/// How one step went.
struct StepReport {
    int newton_iterations = 0;
    int conjugate_gradient_iterations = 0;
    double conjugate_gradient_residual = 0;  ///< of the last solve; see ConjugateGradientResult
    bool repeated = false;                   ///< the energy safeguard repeated the step
    bool lost = false;                       ///< no finite state was found: the body was stopped where it was
};

/// Sums over all steps so far.
struct StepTotals {
    std::int64_t steps = 0;
    std::int64_t newton_iterations = 0;
    std::int64_t conjugate_gradient_iterations = 0;
    std::int64_t repeats = 0;
    std::int64_t lost = 0;
    std::int64_t coarse_refreshes = 0;
    std::int64_t coarse_failures = 0;
    std::int64_t kept_rotations = 0;   ///< blocks of elements whose rotations stayed, see Settings::rotation_bound
    std::int64_t sleeping_blocks = 0;  ///< blocks of elements that were left out, see DeformableBody::set_asleep
    double seconds_forces = 0;         ///< rotations, forces, assembly, energies
    double seconds_solve = 0;          ///< preconditioner and conjugate gradients
    double seconds_rest = 0;           ///< right-hand side and state update
};

/// Energies in joules.
struct Energies {
    double kinetic = 0;
    double elastic = 0;
    double gravity = 0;  ///< zero at rest
    double total() const noexcept { return kinetic + elastic + gravity; }
};

/// A copy of everything that determines how a body goes on: a body of the same scene and settings that restores it
/// repeats the original bit for bit.
class BodyState {
  public:
    BodyState() = default;

  private:
    template <class Real, class Accumulate>
    friend class BodyOf;
    std::vector<double> numbers_;
    std::vector<std::byte> solver_;
    std::vector<double> holds_;
    std::vector<std::uint8_t> sleeping_;
};

/// A deformable body that is stepped through time. Nodes are addressed as in the scene's mesh; the numbering inside,
/// the scalar types, the instruction set and the operator are hidden. After construction no call but save allocates.
///
/// A step of implicit Euler solves, with x^ = x_n + dt v_n (the prediction),
///     (M + dt D + dt^2 K(x^)) dv = dt (f_int(x^) + f_ext) - dt D v_n,  v_n+1 = v_n + dv,  x_n+1 = x^ + dt dv,
/// and goes on from there with Newton iterations if asked for. If the energy then exceeds what it was plus the work of
/// loads and holds, the step is repeated from the new state with a line search on the incremental potential
/// |v - v_n|_M^2 / 2 + W(x_n + dt v) - work of the loads, and slowed down if that does not bring the energy down.
/// StepEquations and ExplicitStep have the equations of the other integrators. Loads that are set before a step are
/// those at its end. Newmark's accelerations are found anew from the forces where positions, velocities or the set of
/// held components have been changed. Held components move at constant speed during a step; with a consistent mass the
/// change of that speed from step to step acts on their neighbours, which is of first order in dt for all integrators.
///
/// The scene's loads act from the start, and are replaced by set_loads. What it prescribes is reached at the end of
/// each step. For its floor see FloorContact; steps in which other nodes come to rest on it than before may allocate.
class DeformableBody {
  public:
    virtual ~DeformableBody() = default;

    /// Advances the body by the settings' time step.
    StepReport step(Scheduler& scheduler) {
        StepReport report;
        for (const StepStage stage : step_stages) report = run(stage, scheduler);
        return report;
    }
    /// One stage of a step, for programs that make each a task. Between the first and the last nothing else may be
    /// asked of the body. The report is complete after the last.
    virtual StepReport run(StepStage stage, Scheduler& scheduler) = 0;

    virtual std::size_t nodes() const noexcept = 0;
    virtual std::size_t elements() const noexcept = 0;
    virtual double time() const noexcept = 0;
    /// Sets the clock by which prescribed displacements go, in seconds.
    virtual void set_time(double time) = 0;
    virtual void positions(std::span<Point> out) const = 0;
    /// Those of some nodes, which must exist.
    virtual void positions(std::span<const std::int32_t> nodes, std::span<Point> out) const = 0;
    virtual Point position(std::int32_t node) const = 0;
    virtual void velocities(std::span<Point> out) const = 0;
    /// Moves the body; rotations start anew from where they are. Fixed nodes keep their places.
    virtual void set_positions(std::span<const Point> positions) = 0;
    virtual void set_velocities(std::span<const Point> velocities) = 0;
    /// Dead loads on nodes, newtons, one per node; they stay until replaced. Loads on fixed nodes do no work.
    virtual void set_loads(std::span<const Point> loads) = 0;
    /// The same for one node. Throws lancet::Error for a node that does not exist and a load that is not finite.
    virtual void set_load(std::int32_t node, const Point& load) = 0;

    /// From the next step on the node moves towards `target` so as to be there at the end of the step, in the
    /// directions normal to nothing (all three) or, with a unit `direction`, along it alone. Replaces an earlier hold
    /// of the node; components that the scene prescribes keep their course. Throws lancet::Error for a fixed node, or a
    /// direction that is not of unit length.
    virtual void hold(std::int32_t node, const Point& target) = 0;
    virtual void hold(std::int32_t node, const Point& target, const Point& direction) = 0;
    virtual void release(std::int32_t node) = 0;
    virtual void release_all() = 0;

    struct NodeMotion {
        Point position{}, velocity{};
    };
    virtual NodeMotion motion(std::int32_t node) const = 0;

    /// Puts nodes to sleep and wakes the others: [node] 1: asleep. What sleeps has no velocity; steps of any integrator
    /// leave it where it is, whatever loads, holds or prescribed displacements say, until it wakes, and spend nothing
    /// on blocks of nodes and elements that sleep as a whole. (They still look at sleepers that share a block with
    /// nodes that are awake, and at the room for nodes of cuts to come; a body of fewer than 64 nodes is one block.)
    /// The rest moves as it would with the sleepers awake, to the tolerance of the linear solver; but what Newton's
    /// method and the energy safeguard decide for the body as a whole, they decide for the rest alone. What wakes
    /// starts with no acceleration. Energies and forces are those of all nodes. set_positions, set_velocities and
    /// change wake all nodes. Takes time proportional to the body's size, and may allocate, as may the next step.
    /// Throws lancet::Error for an element of which some nodes are asleep and others are not.
    virtual void set_asleep(std::span<const std::uint8_t> asleep) = 0;
    virtual bool is_asleep(std::int32_t node) const = 0;

    /// Becomes another body, with work in proportion to what changes. Loads on new nodes are zero, and all holds are
    /// released. Returns false where that cannot be done in place: for block rows, for other scatter strategies than
    /// private copies, and where the room that Settings::numbering asked for is used up. The motion is as it was then,
    /// and the body good for nothing else.
    virtual bool change(const BodyChange& change) = 0;

    /// Energies now. Gravity is measured from the rest position.
    virtual Energies energies(Scheduler& scheduler) = 0;
    /// Elastic force on each node, newtons; zero at fixed nodes.
    virtual void elastic_forces(Scheduler& scheduler, std::span<Point> out) = 0;
    /// A z for the step matrix at the present positions, in N s (z in m / s): for tests and studies. z is taken as zero
    /// at fixed nodes; a filter of held nodes is not applied.
    virtual void apply_matrix(Scheduler& scheduler, std::span<const Point> z, std::span<Point> out) = 0;
    virtual double nodal_mass(std::int32_t node) const = 0;
    /// The longest stable step of the explicit integrators at the present positions, in seconds (see critical_step):
    /// never too long, and too short by less than 1e-6 of it, unless Lanczos' iterations end before. Fixed nodes count,
    /// holds do not. Throws lancet::Error for a consistent mass.
    virtual double critical_time_step(Scheduler& scheduler) = 0;

    virtual BodyState save() const = 0;
    /// Throws lancet::Error if the state is of another scene or other settings.
    virtual void restore(Scheduler& scheduler, const BodyState& state) = 0;

    virtual const Settings& settings() const noexcept = 0;
    virtual const StepTotals& totals() const noexcept = 0;
    virtual void reset_totals() noexcept = 0;
    /// Bytes of all arrays of the body, without the scene's mesh.
    virtual std::size_t bytes() const noexcept = 0;
    virtual int blocks() const noexcept = 0;
    virtual int coarse_unknowns() const noexcept = 0;
    /// Floating-point operations and bytes of one iteration of conjugate gradients: the product with the step matrix,
    /// the preconditioner and the vector passes, each array counted once per pass.
    struct Work {
        double flops = 0;
        double bytes = 0;
    };
    virtual Work solve_work() const noexcept = 0;
};

/// Builds a body. The scheduler is used to set it up; each step takes one of its own. Throws lancet::Error for a scene
/// or settings that make no sense, for one with parts and no preconditioner (unless settings.force_preconditioner), and
/// for an explicit integrator whose time step is longer than the critical one at rest (unless
/// settings.force_time_step).
std::unique_ptr<DeformableBody> make_body(const Scene& scene, const Settings& settings, Scheduler& scheduler);

}  // namespace lancet::runtime
