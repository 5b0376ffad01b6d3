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

void validate(const Settings& settings) {
    const auto require = [](bool holds, const std::string& what) {
        if (!holds) throw Error("settings: " + what);
    };
    require(settings.time_step > 0 && std::isfinite(settings.time_step), "the time step must be positive");
    require(settings.conjugate_gradients.iterations >= 1, "at least one iteration of conjugate gradients is needed");
    require(settings.conjugate_gradients.tolerance >= 0 && settings.conjugate_gradients.tolerance < 1,
            "the tolerance of conjugate gradients must be in [0, 1)");
    require(settings.rotation_interval >= 1, "the rotation interval must be at least 1");
    require(settings.rotation.steps >= 1, "at least one step of the rotation method is needed");
    require(settings.newton_iterations >= 1, "at least one Newton iteration is needed");
    require(settings.newton_tolerance > 0, "the Newton tolerance must be positive");
    require(settings.coarse_change >= 0, "the change that refreshes the coarse space must not be negative");
    require(settings.safeguard_iterations >= 1, "the energy safeguard needs at least one iteration");
    require(settings.numbering.nodes_per_block >= 0 && settings.numbering.nodes_per_aggregate >= 0,
            "numbers of nodes per block and per aggregate must not be negative");
    const bool iterated = settings.newton_iterations > 1 || settings.energy_safeguard ||
                          settings.integrator == Integrator::implicit_midpoint;
    require(!iterated || settings.rotation_interval == 1,
            "a rotation interval above 1 goes with one linearisation, implicit Euler and no energy safeguard");
    require(settings.integrator == Integrator::implicit_euler || !settings.energy_safeguard,
            "the energy safeguard goes with implicit Euler, not with the midpoint rule");
    require(settings.newton_iterations == 1 || settings.linearisation == Linearisation::prediction,
            "Newton iterations start at the prediction; linearisation at the state goes with one");
    kernels::require(settings.instruction_set);
}

}  // namespace lancet::runtime
