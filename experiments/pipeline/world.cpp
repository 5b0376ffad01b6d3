#include "lancet/experiments/pipeline/world.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "lancet/experiments/common/organ_mesh.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/collide/vector3.hpp"

namespace lancet::experiments::pipeline {

using runtime::add_scaled;
using runtime::subtract;

namespace {

/// A place by its shares of the box around the body.
Point in_box(const World& world, const Point& share) {
    Point at{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        at[axis] = world.lower[axis] + share[axis] * (world.upper[axis] - world.lower[axis]);
    }
    return at;
}

}  // namespace

World make_world(const PipelineSettings& settings, runtime::Scheduler& scheduler) {
    World world;
    world.simulation = std::make_unique<runtime::Simulation>(
        scheduler, runtime::SimulationOptions{.time_step = settings.time_step,
                                              .frame_rate = settings.frame_rate,
                                              .collision_rate = settings.collision_rate,
                                              .overlap = settings.overlaps});
    runtime::BodyDefinition body{.name = settings.scene, .can_be_cut = settings.cuts};
    body.settings.time_step = settings.time_step;
    body.settings.instruction_set = settings.instruction_set;
    if (settings.scene == "bar") {
        body.scene.mesh = mesh::box({.cells = {40, 8, 8}, .size = {4, 0.8, 0.8}});
        // The Bar of the benchmarks, held at both ends: held at one it hangs down by three quarters of its length.
        for (const char* side : {"x_min", "x_max"}) {
            const auto nodes = body.scene.mesh.node_set(side);
            body.scene.fixed_nodes.insert(body.scene.fixed_nodes.end(), nodes.begin(), nodes.end());
        }
        body.scene.materials[0] = {.young_modulus = 1e5, .poisson_ratio = 0.33, .density = 100};
        world.sag = 0.17;
    } else {
        body.scene.mesh = organ_mesh(5, 16);
        const auto [lower, upper] = body.scene.mesh.bounds();
        // Held by what would lie on the table.
        for (std::size_t node = 0; node < body.scene.mesh.nodes().size(); ++node) {
            const double share = (body.scene.mesh.nodes()[node][1] - lower[1]) / (upper[1] - lower[1]);
            if (share < 0.2) body.scene.fixed_nodes.push_back(static_cast<std::int32_t>(node));
        }
        body.scene.materials[0] = {.young_modulus = 2e4, .poisson_ratio = 0.4, .density = 1000};
        body.scene.rayleigh_mass = 2;
    }
    std::tie(world.lower, world.upper) = std::pair{body.scene.mesh.bounds()[0], body.scene.mesh.bounds()[1]};
    world.elements = body.scene.mesh.tetrahedra().size();
    world.body = world.simulation->add_body(std::move(body));

    const Point size = subtract(world.upper, world.lower);
    const double thick = std::min(size[1], size[2]);
    // A rod that comes from above; its blade goes through the width of the body.
    world.tool_shape = {.start = {0, 0, 0}, .end = {0, 1.2 * thick, 0}, .radius = 0.12 * thick};
    runtime::ToolDefinition tool{.name = "tool",
                                 .shape = world.tool_shape,
                                 .blade = std::array<Point, 2>{{{0, 0, -0.7 * size[2]}, {0, 0, 0.7 * size[2]}}},
                                 .grab_distance = 0.06 * thick,
                                 .is_recorded = !settings.record.empty()};
    if (!settings.cuts) tool.blade.reset();
    world.tool = world.simulation->add_tool(std::move(tool));
    world.camera.target = in_box(world, {0.5, 0.45, 0.5});
    world.camera.eye =
        add_scaled(add_scaled(world.camera.target, 1.25 * size[0], {0.15, 0.45, 1}), 0.2 * size[2], {0, 0, 1});
    return world;
}

runtime::ToolPath built_in_path(const World& world, const PipelineSettings& settings) {
    using runtime::ToolAction;
    runtime::ToolPath corners;
    const auto go = [&](double seconds, Point share, ToolAction action) {
        const double time = corners.empty() ? 0 : corners.back().time + seconds;
        share[1] -= world.sag * std::pow(4 * share[0] * (1 - share[0]), 2);
        corners.push_back({.time = time, .pose = {.position = in_box(world, share)}, .action = action});
    };
    // The rod's lower end touches what is a radius, 0.12 of the thickness, below it.
    const double touching = 1 + 0.10, above = 1.6, pressed = 0.95;
    go(0, {0.8, above, 0.5}, ToolAction::touch);
    for (int round = 0; corners.back().time < settings.seconds; ++round) {
        const double x = 0.55 + 0.3 * std::abs(std::sin(1.3 * round));
        go(0.6, {x, above, 0.45}, ToolAction::touch);
        go(0.5, {x, pressed, 0.45}, ToolAction::touch);
        go(0.8, {x - 0.15, pressed, 0.55}, ToolAction::touch);
        go(0.4, {x - 0.15, touching, 0.55}, ToolAction::grab);
        go(0.8, {x - 0.15, touching + 0.35, 0.55}, ToolAction::grab);
        go(0.6, {x - 0.15, touching, 0.55}, ToolAction::grab);
        go(0.3, {x - 0.15, above, 0.55}, ToolAction::touch);
        if (settings.cuts && round % 2 == 0) {
            const double place = 0.35 + 0.11 * ((round / 2) % 5);
            go(0.4, {place, 1.3, 0.5}, ToolAction::touch);
            go(0.01, {place, 1.3, 0.5}, ToolAction::cut);
            go(1.2, {place, 0.62, 0.5}, ToolAction::cut);
            go(0.01, {place, 0.62, 0.5}, ToolAction::idle);
            go(0.3, {place, above, 0.5}, ToolAction::idle);
        }
    }
    return runtime::resampled(corners, 1 / settings.force_rate);
}

}  // namespace lancet::experiments::pipeline
