#pragma once

#include <optional>
#include <string_view>

#include "lancet/kernels/isa/instruction_set.hpp"
#include "lancet/kernels/layout/node_numbering.hpp"
#include "lancet/kernels/layout/scatter_plan.hpp"
#include "lancet/mesh/order.hpp"
#include "lancet/runtime/solve/conjugate_gradients.hpp"

namespace lancet::runtime {

/// The arithmetic of a solve. Positions and velocities are double in all of them, and differences of positions are
/// formed in double.
enum class ScalarMode {
    single_precision,  ///< "float": forces, operator, preconditioner and vectors in float
    mixed,             ///< forces and operator in float, residual and solution of the linear system in double
    double_precision   ///< "double"
};
std::string_view to_string(ScalarMode mode) noexcept;
ScalarMode scalar_mode_from_string(std::string_view name);

/// Where the step is linearised first.
enum class Linearisation {
    state,      ///< at x_n: the original method
    prediction  ///< at x_n + dt v_n: as cheap, and some thirty times more accurate on the Bar
};
std::string_view to_string(Linearisation linearisation) noexcept;

/// How a step goes through time. h is the time step, f all forces, D the damping.
enum class Integrator {
    implicit_euler,     ///< order 1, damps what it does not resolve; the only one with the energy safeguard
    implicit_midpoint,  ///< order 2, keeps momenta, and the energy of the linear model
    energy_momentum,  ///< order 2, Simo and Tarnow (1992): the midpoint rule with the average stress of the step, which
                      ///< iterated to a tolerance keeps momenta and energy; for the linear and the St.
                      ///< Venant-Kirchhoff model
    newmark,          ///< Newmark (1959); order 2 for gamma = 1/2, else 1
    symplectic_euler,    ///< order 1, explicit: v += h M^-1 f(x), then x += h v
    central_differences  ///< order 2, explicit, as velocity Verlet
};
std::string_view to_string(Integrator integrator) noexcept;
Integrator integrator_from_string(std::string_view name);

/// Explicit integrators solve no system: they need a lumped mass and a step below the critical one.
constexpr bool is_explicit(Integrator integrator) noexcept {
    return integrator == Integrator::symplectic_euler || integrator == Integrator::central_differences;
}

/// How a body is computed. The defaults are the fastest accurate choice for interactive steps.
struct Settings {
    double time_step = 0.04;  ///< s
    Integrator integrator = Integrator::implicit_euler;
    /// Newmark's parameters: x += h v + h^2 ((1/2 - beta) a_n + beta a_n+1), v += h ((1 - gamma) a_n + gamma a_n+1).
    /// gamma below 1/2 makes energy grow; 2 beta >= gamma >= 1/2 is stable for every step, less only for short ones.
    double newmark_beta = 0.25;
    double newmark_gamma = 0.5;
    bool force_time_step = false;  ///< take an explicit step even if it is longer than the critical one
    ElementModel model = ElementModel::corotational;
    TangentKind tangent = TangentKind::rotated;  ///< see ElasticLaw
    /// By default row sums for implicit integrators, which keep the centre of mass of each part of a cut element, and
    /// fractions for explicit ones, whose critical step then is at least that of the single elements, whatever is cut;
    /// without cuts both are the same.
    std::optional<MassKind> mass{};
    ScalarMode scalar = ScalarMode::single_precision;
    kernels::InstructionSet instruction_set = kernels::active_instruction_set();
    OperatorKind matrix = OperatorKind::edge_blocks;
    kernels::ScatterStrategy scatter = kernels::ScatterStrategy::private_copies;
    RotationSettings rotation{};
    int rotation_interval = 1;  ///< rotations and operator are renewed every so many steps
    /// And then only in blocks of elements whose F may have changed by more than this since (Frobenius norm). 0:
    /// everywhere. For implicit integrators and the rotated tangent.
    double rotation_bound = 0;
    Linearisation linearisation = Linearisation::prediction;
    ConjugateGradientSettings conjugate_gradients{};
    PreconditionerKind preconditioner = PreconditionerKind::coarse;
    bool force_preconditioner = false;  ///< take `none` for a scene with parts, whose thin ones it does not see
    double coarse_change = 0.2;         ///< see Preconditioner
    int newton_iterations = 1;          ///< at most; 1: linearised once
    double newton_tolerance = 1e-8;     ///< of the residual against that at the first linearisation and the loads
    bool energy_safeguard = true;       ///< repeat a step that gained energy without work (see DeformableBody::step)
    int safeguard_iterations = 8;       ///< Newton iterations of such a repeat, at most
    mesh::OrderingKind ordering = mesh::OrderingKind::hilbert;
    kernels::NumberingOptions numbering{};
};

/// The kind of mass that settings come to.
constexpr MassKind mass_kind(const Settings& settings) noexcept {
    return settings.mass.value_or(is_explicit(settings.integrator) ? MassKind::fraction : MassKind::lumped);
}

/// Throws lancet::Error for settings that make no sense or contradict each other.
void validate(const Settings& settings);

}  // namespace lancet::runtime
