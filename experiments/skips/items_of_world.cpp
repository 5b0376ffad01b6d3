#include <array>
#include <cmath>
#include <numbers>
#include <utility>

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

/// The bar, cut in two over a floor. After 10 s the severed half lies there at rest, while a probe goes up and down on
/// the half that is held.
std::unique_ptr<Runner> severed_bar(bool is_quick, double speed) {
    const auto describe = [=](Simulation& world) {
        runtime::Scene scene = bar(is_quick);
        scene.floor = runtime::Floor{.point = {0, -0.5, 0}, .normal = {0, 1, 0}};
        scene.rayleigh_mass = 1;
        const int body = world.add_body({.name = "bar", .scene = std::move(scene), .can_be_cut = true});
        runtime::Blade blade;
        for (const double z : {-0.3, 1.1}) {
            world.body(body).draw(blade, one_thread(), {2.03, -0.3, z}, {2.03, 1.1, z});
        }
        constexpr double radius = 0.2, period = 0.8, step = 0.04, end = 60;
        const int tool = world.add_tool({.name = "probe", .shape = runtime::SphereTool{.radius = radius}});
        runtime::ToolPath path;
        for (double time = 0; time < end; time += step) {
            const double height = 0.8 + radius - 0.15 * (1 - std::cos(2 * std::numbers::pi * time / period));
            path.push_back({.time = time, .pose = {.position = {1, height, 0.4}}});
        }
        world.play(tool, path);
    };
    constexpr int until_at_rest = 250;
    return run_world({.sleep = {.speed = speed, .after = 0.2}}, describe, 1, until_at_rest);
}

/// The bar, held at its end, has come to rest; then its outer half is cut off and falls.
std::unique_ptr<Runner> falling_half(bool is_quick, double speed) {
    const auto describe = [=](Simulation& world) {
        runtime::Scene scene = bar(is_quick);
        scene.rayleigh_mass = 5;
        const int body = world.add_body({.name = "bar", .scene = std::move(scene), .can_be_cut = true});
        runtime::Blade blade;
        for (const double z : {-0.3, 1.1}) {
            world.body(body).draw(blade, one_thread(), {2.03, -0.3, z}, {2.03, 1.1, z});
        }
    };
    constexpr int until_held_rests = 125;  // 5 s
    return run_world({.collision_rate = 0, .sleep = {.speed = speed, .after = 0.2}}, describe, 1, until_held_rests);
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
        {.name = "an island at rest sleeps: what was cut off",
         .toggle = "SimulationOptions::sleep.speed = 1e-3 m/s; without: 0",
         .scene = bar_name + " cut in two: one half lies on a floor, the other is held and poked",
         .with = [=] { return severed_bar(is_quick, 1e-3); },
         .without = [=] { return severed_bar(is_quick, 0); }},
        {.name = "an island at rest sleeps: what is held",
         .toggle = "SimulationOptions::sleep.speed = 1e-3 m/s; without: 0",
         .scene = bar_name + " cut in two: one half falls, the other is held",
         .with = [=] { return falling_half(is_quick, 1e-3); },
         .without = [=] { return falling_half(is_quick, 0); }},
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
