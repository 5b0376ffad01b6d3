#include "lancet/experiments/skips/items.hpp"

namespace lancet::experiments::skips {
namespace {

/// The bar with all nodes of x <= 2 m in place: fixed for good, or held by constraints of the solve.
std::unique_ptr<Runner> half_fixed(bool is_quick, bool is_eliminated) {
    runtime::Scene scene = bar(is_quick);
    std::vector<std::int32_t> nodes;
    for (std::size_t node = 0; node < scene.mesh.nodes().size(); ++node) {
        if (scene.mesh.nodes()[node][0] <= 2) nodes.push_back(static_cast<std::int32_t>(node));
    }
    scene.fixed_nodes = is_eliminated ? nodes : std::vector<std::int32_t>{};
    const auto hold = [&](runtime::DeformableBody& body) {
        for (const std::int32_t node : nodes) body.hold(node, scene.mesh.nodes()[static_cast<std::size_t>(node)]);
    };
    return is_eliminated ? run_body(scene, {}) : run_body(scene, {}, hold);
}

/// A stiff bar, which bends by millimetres.
std::unique_ptr<Runner> stiff(bool is_quick, runtime::ElementModel model) {
    runtime::Scene scene = bar(is_quick);
    scene.materials[0].young_modulus = 1e8;
    return run_body(scene, {.model = model});
}

/// The bar in a tenth of gravity, with drag, in small steps.
std::unique_ptr<Runner> slow(bool is_quick, double rotation_bound) {
    runtime::Scene scene = bar(is_quick);
    for (double& component : scene.gravity) component *= 0.1;
    scene.rayleigh_mass = 5;
    return run_body(scene, {.time_step = 0.005, .rotation_bound = rotation_bound});
}

runtime::Settings unguarded(int rotation_interval) {
    return {.rotation_interval = rotation_interval, .energy_safeguard = false};
}

}  // namespace

std::vector<Item> items_of_body(bool is_quick) {
    const std::string bar_name = is_quick ? "Bar, 1,600 elements" : "Bar";
    const auto bar_with = [=](const runtime::Settings& settings) {
        return [=] { return run_body(bar(is_quick), settings); };
    };
    constexpr int many = 40;
    return {
        {.name = "fixed nodes out of the solve",
         .toggle = "Scene::fixed_nodes; without: DeformableBody::hold",
         .scene = bar_name + ", half of it in place",
         .with = [=] { return half_fixed(is_quick, true); },
         .without = [=] { return half_fixed(is_quick, false); },
         .note = "ten iterations end elsewhere on another system"},
        {.name = "linear material: constant operator, no rotations",
         .toggle = "Settings::model = linear; without: corotational",
         .scene = bar_name + ", E = 100 MPa",
         .with = [=] { return stiff(is_quick, runtime::ElementModel::linear); },
         .without = [=] { return stiff(is_quick, runtime::ElementModel::corotational); },
         .note = "the error is that of the model"},
        {.name = "rotations and operator every 5th step",
         .toggle = "Settings::rotation_interval = 5; without: 1",
         .scene = bar_name + ", no energy check",
         .with = bar_with(unguarded(5)),
         .without = bar_with(unguarded(1)),
         .note = "a unit is a step: four of five skip"},
        {.name = "rotations only where the deformation changed",
         .toggle = "Settings::rotation_bound = 0.02; without: 0",
         .scene = bar_name + ", a tenth of gravity, drag, steps of 5 ms",
         .with = [=] { return slow(is_quick, 0.02); },
         .without = [=] { return slow(is_quick, 0); },
         .note = "blocks of elements; what turns fast gains nothing"},
        {.name = "coarse space only where the shape changed",
         .toggle = "Settings::coarse_change = 0.2; without: 0",
         .scene = bar_name,
         .with = bar_with({}),
         .without = bar_with({.coarse_change = 0})},
        {.name = "conjugate gradients stop at their tolerance",
         .toggle = "ConjugateGradientSettings::tolerance = 1e-3; without: 0",
         .scene = bar_name + ", at most 40 iterations",
         .with = bar_with({.conjugate_gradients = {.iterations = many, .tolerance = 1e-3}}),
         .without = bar_with({.conjugate_gradients = {.iterations = many, .tolerance = 0}})},
    };
}

}  // namespace lancet::experiments::skips
