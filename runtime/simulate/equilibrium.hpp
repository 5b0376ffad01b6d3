#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lancet/runtime/simulate/floating.hpp"
#include "lancet/runtime/simulate/loads.hpp"
#include "lancet/runtime/simulate/settings.hpp"

namespace lancet::runtime {

/// How a static equilibrium is looked for. The defaults are those of a verification: all in double, the
/// exact tangent.
struct EquilibriumSettings {
    ElementModel model = ElementModel::corotational;
    TangentKind tangent = TangentKind::exact;
    /// single_precision: all in float. mixed: residual and energy in double, tangent and linear solves in float, which
    /// for the linear model is iterative refinement to double accuracy. double_precision: all in double.
    ScalarMode scalar = ScalarMode::double_precision;
    kernels::InstructionSet instruction_set = kernels::active_instruction_set();
    OperatorKind matrix = OperatorKind::edge_blocks;
    kernels::ScatterStrategy scatter = kernels::ScatterStrategy::private_copies;
    RotationSettings rotation{};
    /// The coarse space knows of nodes that are held in all components; where those do not hold the body, it gives way
    /// to block Jacobi, which it is made of.
    PreconditionerKind preconditioner = PreconditionerKind::coarse;
    bool force_preconditioner = false;         ///< see Settings
    double tolerance = 1e-9;                   ///< of the residual against the loads, or the reactions where none are
    int newton_iterations = 50;                ///< at most, for each load step
    int conjugate_gradient_iterations = 5000;  ///< at most, for each linear solve
    int load_steps = 1;                        ///< how many to begin with; a step that fails is halved
    double smallest_load_step = 1.0 / 1024;    ///< of the full load
    bool hold_floating = false;  ///< hold three nodes of each component that nothing holds, instead of an error
    mesh::OrderingKind ordering = mesh::OrderingKind::hilbert;
    kernels::NumberingOptions numbering{};
};

/// Throws lancet::Error for settings that make no sense.
void validate(const EquilibriumSettings& settings);

/// How the search ended.
enum class EquilibriumEnd {
    converged,      ///< the residual is below the tolerance at the full load
    stagnated,      ///< neither the residual nor the energy fell any further
    lost_stability  ///< the equilibrium that the load steps followed ceased to be stable
};
std::string_view to_string(EquilibriumEnd end) noexcept;

struct EquilibriumReport {
    EquilibriumEnd end = EquilibriumEnd::stagnated;
    double load_factor = 0;  ///< the largest at which an equilibrium was found: 1 is the full load
    double residual = 0;     ///< |f_int + f_ext| over the free nodes, against the reference of the tolerance
    double elastic_energy = 0;
    double potential_energy = 0;  ///< elastic energy less the work of the dead loads on the way from rest
    int load_steps = 0;           ///< that were finished
    int newton_iterations = 0;
    int conjugate_gradient_iterations = 0;
    int held_components = 0;          ///< floating components that `hold_floating` held
    std::vector<double> residuals{};  ///< after each Newton iteration of the last load step
    std::string explanation{};        ///< one line: what happened, where
};

/// Finds the static equilibrium of a scene under gravity, its loads and prescribed displacements (taken at time 0), all
/// scaled together by a load factor that goes from 0 to 1.
///
/// Newton's method on the potential energy with a line search; the linear solves are conjugate gradients, ended early
/// far from the solution (Eisenstat and Walker 1996, choice 2). A load step that does not converge, or on which the
/// tangent shows itself indefinite, is halved from the last equilibrium; when it becomes too small the search ends, and
/// says why. `positions`, in the mesh's order, hold the start (the rest positions, or a guess) and take the result: the
/// last equilibrium that was found. All in float, rounding of the forces may hide a residual that is still large, with
/// stiff inclusions, nearly incompressible materials or flat elements: the search then ends as stagnated where it is,
/// with the residual it has reached, and its explanation says so.
///
/// Throws lancet::Error for a scene or settings that make no sense, for one with parts and no preconditioner (unless
/// settings.force_preconditioner), for a floor, and for components that nothing holds
/// in all six rigid motions, naming them, unless `hold_floating` is set.
EquilibriumReport find_equilibrium(const Scene& scene, const EquilibriumSettings& settings, Scheduler& scheduler,
                                   std::span<Point> positions);

}  // namespace lancet::runtime
