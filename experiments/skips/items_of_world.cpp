#include <array>

#include "lancet/experiments/skips/items.hpp"
#include "lancet/mesh/generate/box.hpp"

namespace lancet::experiments::skips {
namespace {

using runtime::Simulation;
using runtime::SimulationOptions;

void add_bar(Simulation& world, bool is_quick, double time_step) {
    world.add_body({.name = "bar", .scene = bar(is_quick), .settings = {.time_step = time_step}});
}

/// A tool that stands 5 cm above the bar, near its clamp.
void add_tool(Simulation& world) {
    constexpr double radius = 0.1;
    const int tool = world.add_tool({.name = "probe", .shape = runtime::SphereTool{.radius = radius}});
    world.play(tool, {{.time = 0, .pose = {.position = {0.4, 0.85 + radius, 0.4}}}});
}

/// Four short stiff bars that have come to rest, and one that swings.
std::unique_ptr<Runner> four_at_rest(bool is_quick, double speed) {
    const auto describe = [=](Simulation& world) {
        for (int number = 0; number < 4; ++number) {
            runtime::Scene scene;
            scene.mesh = mesh::box({.cells = is_quick ? std::array{8, 4, 4} : std::array{16, 8, 8},
                                    .size = {0.8, 0.4, 0.4},
                                    .origin = {0, 2.0 * number, 5}});
            const auto clamped = scene.mesh.node_set("x_min");
            scene.fixed_nodes.assign(clamped.begin(), clamped.end());
            scene.materials = {{0, {.young_modulus = 1e6, .poisson_ratio = 0.33, .density = 100}}};
            scene.rayleigh_mass = 2;
            world.add_body({.name = "short bar " + std::to_string(number), .scene = std::move(scene)});
        }
        runtime::Scene swinging = bar(true);
        world.add_body({.name = "bar", .scene = std::move(swinging)});
    };
    constexpr int until_at_rest = 125;  // 5 s
    return run_world({.collision_rate = 0, .sleep = {.speed = speed, .after = 0.2}}, describe, 1, until_at_rest);
}

}  // namespace

std::vector<Item> items_of_world(bool is_quick) {
    const std::string bar_name = is_quick ? "Bar, 1,600 elements" : "Bar";
    const auto with_tool = [=](double collision_rate, bool has_tool) {
        return [=] {
            return run_world({.collision_rate = collision_rate}, [=](Simulation& world) {
                add_bar(world, is_quick, 0.04);
                if (has_tool) add_tool(world);
            });
        };
    };
    const auto with_frames = [=](bool are_observed) {
        return [=] {
            return run_world({}, [=](Simulation& world) {
                add_bar(world, is_quick, 0.04);
                if (are_observed) world.observe_frames([](const runtime::Frame&) {});
            });
        };
    };
    // Twenty steps of 5 ms: three frames at 30 Hz, twenty at every step.
    constexpr int steps = 20;
    const auto at_rate = [=](double frames, double collisions) {
        return [=] {
            const SimulationOptions options{.time_step = 0.005, .frame_rate = frames, .collision_rate = collisions};
            return run_world(
                options,
                [=](Simulation& world) {
                    add_bar(world, is_quick, 0.005);
                    if (frames > 0) world.observe_frames([](const runtime::Frame&) {});
                    if (collisions > 0) add_tool(world);
                },
                steps);
        };
    };
    return {
        {.name = "bodies at rest sleep",
         .toggle = "SimulationOptions::sleep.speed = 1e-3 m/s; without: 0",
         .scene = "four bars at rest, one of 1,600 elements that swings; no collision",
         .with = [=] { return four_at_rest(is_quick, 1e-3); },
         .without = [=] { return four_at_rest(is_quick, 0); }},
        {.name = "no collider, no collision task",
         .toggle = "no Simulation::add_tool; without: a tool, 200 Hz",
         .scene = bar_name + "; the tool does not touch",
         .with = with_tool(200, false),
         .without = with_tool(200, true)},
        {.name = "no observer, no frame task",
         .toggle = "no Simulation::observe_frames; without: frames at every step",
         .scene = bar_name + ", steps of 40 ms",
         .with = with_frames(false),
         .without = with_frames(true)},
        {.name = "frames at the frame rate",
         .toggle = "SimulationOptions::frame_rate = 30 Hz; without: 200",
         .scene = bar_name + ", steps of 5 ms",
         .unit = "20 steps",
         .with = at_rate(30, 0),
         .without = at_rate(200, 0),
         .units = 10},
        {.name = "collision at its rate",
         .toggle = "SimulationOptions::collision_rate = 50 Hz; without: 200",
         .scene = bar_name + ", steps of 5 ms",
         .unit = "20 steps",
         .with = at_rate(0, 50),
         .without = at_rate(0, 200),
         .units = 10},
    };
}

}  // namespace lancet::experiments::skips
