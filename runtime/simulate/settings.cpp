#include "lancet/runtime/simulate/settings.hpp"

#include <cmath>
#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {

std::string_view to_string(ScalarMode mode) noexcept {
    switch (mode) {
        case ScalarMode::single_precision:
            return "float";
        case ScalarMode::mixed:
            return "mixed";
        default:
            return "double";
    }
}

ScalarMode scalar_mode_from_string(std::string_view name) {
    for (const ScalarMode mode : {ScalarMode::single_precision, ScalarMode::mixed, ScalarMode::double_precision}) {
        if (to_string(mode) == name) return mode;
    }
    throw Error("unknown scalar '" + std::string(name) + "'; expected float, mixed or double");
}

std::string_view to_string(Linearisation linearisation) noexcept {
    return linearisation == Linearisation::state ? "state" : "prediction";
}

std::string_view to_string(Integrator integrator) noexcept {
    switch (integrator) {
        case Integrator::implicit_euler:
            return "implicit-euler";
        case Integrator::implicit_midpoint:
            return "implicit-midpoint";
        case Integrator::energy_momentum:
            return "energy-momentum";
        case Integrator::newmark:
            return "newmark";
        case Integrator::symplectic_euler:
            return "symplectic-euler";
        default:
            return "central-differences";
    }
}

Integrator integrator_from_string(std::string_view name) {
    for (const Integrator integrator :
         {Integrator::implicit_euler, Integrator::implicit_midpoint, Integrator::energy_momentum, Integrator::newmark,
          Integrator::symplectic_euler, Integrator::central_differences}) {
        if (to_string(integrator) == name) return integrator;
    }
    throw Error("unknown integrator '" + std::string(name) +
                "'; expected implicit-euler, implicit-midpoint, energy-momentum, newmark, symplectic-euler or "
                "central-differences");
}

void validate(const Settings& settings) {
    const auto require = [](bool holds, const std::string& what) {
        if (!holds) throw Error("settings: " + what);
    };
    require(settings.time_step > 0 && std::isfinite(settings.time_step), "the time step must be positive");
    require(settings.conjugate_gradients.iterations >= 1, "at least one iteration of conjugate gradients is needed");
    require(settings.conjugate_gradients.tolerance >= 0 && settings.conjugate_gradients.tolerance < 1,
            "the tolerance of conjugate gradients must be in [0, 1)");
    require(settings.rotation_interval >= 1, "the rotation interval must be at least 1");
    require(settings.rotation_bound >= 0 && std::isfinite(settings.rotation_bound),
            "the bound on changes that rotations stay for must not be negative");
    require(
        settings.rotation_bound == 0 || (!is_explicit(settings.integrator) && settings.tangent == TangentKind::rotated),
        "a rotation bound goes with implicit integrators and the rotated tangent");
    require(settings.rotation.steps >= 1, "at least one step of the rotation method is needed");
    require(settings.newton_iterations >= 1, "at least one Newton iteration is needed");
    require(settings.newton_tolerance > 0, "the Newton tolerance must be positive");
    require(settings.coarse_change >= 0, "the change that refreshes the coarse space must not be negative");
    require(settings.safeguard_iterations >= 1, "the energy safeguard needs at least one iteration");
    require(settings.numbering.nodes_per_block >= 0 && settings.numbering.nodes_per_aggregate >= 0,
            "numbers of nodes per block and per aggregate must not be negative");
    const bool is_euler = settings.integrator == Integrator::implicit_euler;
    const bool iterated = settings.newton_iterations > 1 || settings.energy_safeguard || !is_euler;
    require(!iterated || settings.rotation_interval == 1,
            "a rotation interval above 1 goes with one linearisation, implicit Euler and no energy safeguard");
    require(is_euler || !settings.energy_safeguard,
            "the energy safeguard goes with implicit Euler; switch it off for " +
                std::string(to_string(settings.integrator)));
    require(settings.integrator != Integrator::energy_momentum || settings.model != ElementModel::corotational,
            "energy-momentum is for the linear and the St. Venant-Kirchhoff model: the corotational one has no average "
            "stress");
    require(settings.integrator != Integrator::energy_momentum || settings.linearisation == Linearisation::prediction,
            "energy-momentum is linearised at the prediction");
    require(settings.integrator != Integrator::newmark || settings.linearisation == Linearisation::prediction,
            "Newmark's method is linearised at the prediction");
    require(settings.newmark_gamma > 0 && std::isfinite(settings.newmark_gamma), "Newmark's gamma must be positive");
    require(settings.newmark_beta > 0 && std::isfinite(settings.newmark_beta),
            "Newmark's beta must be positive; beta = 0 is the integrator central-differences");
    require(!is_explicit(settings.integrator) || settings.mass != MassKind::consistent,
            std::string(to_string(settings.integrator)) + " is explicit and needs a lumped mass");
    require(!is_explicit(settings.integrator) || settings.newton_iterations == 1,
            std::string(to_string(settings.integrator)) + " is explicit and has no Newton iterations");
    require(settings.newton_iterations == 1 || settings.linearisation == Linearisation::prediction,
            "Newton iterations start at the prediction; linearisation at the state goes with one");
    kernels::require_tangent(settings.model, settings.tangent);
    kernels::require(settings.instruction_set);
}

}  // namespace lancet::runtime
