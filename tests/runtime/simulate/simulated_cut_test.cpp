// What a blade does to bodies.
#include <algorithm>
#include <string>
#include <vector>

#include "tests/runtime/simulate/simulated_bars.hpp"
#include <gtest/gtest.h>

namespace lancet::runtime {
namespace {

using namespace test;

/// What comes of two bars, one below the other, that one blade goes through at the same time.
struct Outcome {
    std::vector<std::vector<Point>> bodies{};
    std::vector<std::int64_t> cuts{};  ///< [body]
    CutStatistics all{};
};

Outcome cut_two_bars(SchedulerKind kind, int threads) {
    const auto scheduler = make_scheduler(kind, threads);
    Simulation simulation(*scheduler, {.time_step = time_step});
    for (const double height : {0.0, -0.3}) {
        BodyDefinition definition = bar(height == 0 ? "upper" : "lower", true, {0, height, 0});
        definition.can_be_cut = true;
        simulation.add_body(std::move(definition));
    }
    // Its edge is upright: it goes into both from the side.
    const int tool = simulation.add_tool({.name = "blade", .blade = std::array<Point, 2>{{{0, -0.6, 0}, {0, 0.6, 0}}}});
    simulation.play(tool,
                    resampled(ToolPath{{.time = 0, .pose = {.position = {0.43, 0, -0.3}}, .action = ToolAction::cut},
                                       {.time = 0.3, .pose = {.position = {0.43, 0, 0.4}}, .action = ToolAction::cut}},
                              time_step));
    simulation.keep_surfaces();
    for (int step = 0; step < 20; ++step) simulation.step();
    Outcome outcome{.all = simulation.cut_statistics()};
    for (int body = 0; body < simulation.bodies(); ++body) {
        outcome.bodies.push_back(positions(simulation.body(body)));
        outcome.cuts.push_back(simulation.body(body).cuts());
    }
    return outcome;
}

TEST(SimulatedCut, BodiesThatOneBladeGoesThroughAtTheSameTimeAreTheSameOnEveryScheduler) {
    const Outcome expected = cut_two_bars(SchedulerKind::serial, 1);
    const std::size_t whole = bar("whole").scene.mesh.nodes().size();
    for (std::size_t body = 0; body < 2; ++body) {
        EXPECT_GT(expected.cuts[body], 1) << "several strokes";
        EXPECT_GT(expected.bodies[body].size(), whole) << "cut";
    }
    EXPECT_EQ(expected.all.cuts, expected.cuts[0] + expected.cuts[1]);
    EXPECT_EQ(expected.all.copies, expected.bodies[0].size() + expected.bodies[1].size() - 2 * whole);
    EXPECT_GE(expected.all.seconds, expected.all.longest);
    EXPECT_GT(expected.all.longest, 0);
    for (const SchedulerKind kind : available_schedulers()) {
        for (const int threads : {1, 2, 3}) {
            const Outcome outcome = cut_two_bars(kind, threads);
            const std::string on = std::string(to_string(kind)) + ", " + std::to_string(threads) + " threads";
            EXPECT_TRUE(outcome.bodies == expected.bodies) << on;
            EXPECT_EQ(outcome.cuts, expected.cuts) << on;
            EXPECT_EQ(outcome.all.cuts, expected.all.cuts) << on;
            EXPECT_EQ(outcome.all.elements, expected.all.elements) << on;
            EXPECT_EQ(outcome.all.copies, expected.all.copies) << on;
        }
    }
}

/// A free bar without gravity whose nodes carry loads along z that were set from outside, while a probe pushes it down
/// or does not, is cut, and then left alone.
void expect_rest_of_forces_to_end(bool is_pushed, double room) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler, {.time_step = time_step, .gravity = {0, 0, 0}});
    BodyDefinition definition = bar("bar", false);
    definition.can_be_cut = true;
    definition.cuts.room = room;
    // It would take a rise of the energy by rounding for one that has to be slowed down.
    definition.settings.energy_safeguard = false;
    simulation.add_body(std::move(definition));
    const int probe = simulation.add_tool({.name = "probe", .shape = SphereTool{.radius = 0.05}});
    const int blade =
        simulation.add_tool({.name = "blade", .blade = std::array<Point, 2>{{{0, -0.6, 0}, {0, 0.6, 0}}}});
    SimulatedBody& body = simulation.body(0);
    const auto momentum = [&] {
        std::vector<Point> velocities(body.body().nodes());
        body.body().velocities(velocities);
        Point sum{};
        for (std::size_t node = 0; node < velocities.size(); ++node) {
            const double mass = body.body().nodal_mass(static_cast<std::int32_t>(node));
            for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += mass * velocities[node][axis];
        }
        return sum;
    };
    const mesh::TetMesh mesh = bar("bar").scene.mesh;
    const auto nodes = mesh.nodes();
    const auto touched = static_cast<std::int32_t>(
        std::ranges::find_if(nodes, [](const Point& at) { return at[0] > 0.65 && at[1] > 0.15 && at[2] > 0.05; }) -
        nodes.begin());
    for (const double x : {0.43, 0.23}) {
        constexpr double load = 1e-2;
        const Point at_first = momentum();
        body.set_loads(std::vector<Point>(body.body().nodes(), Point{0, 0, load}));
        const double impulse = 3 * time_step * load * static_cast<double>(body.body().nodes());
        // What a solve that is not converged loses of it.
        const double lost = 0.05 * impulse;
        const auto press = [&](ToolAction action) {
            if (!is_pushed) return;
            Point above = body.body().position(touched);
            above[1] += 0.04;
            simulation.move(probe, {.position = above}, action);
        };
        press(ToolAction::touch);
        for (int step = 0; step < 3; ++step) simulation.step();
        EXPECT_EQ(momentum()[1] - at_first[1] < -lost, is_pushed);
        EXPECT_NEAR(momentum()[2] - at_first[2], impulse, lost);
        const std::int64_t copies = simulation.cut_statistics().copies;
        for (const double z : {-0.3, 0.5}) {
            simulation.move(blade, {.position = {x, 0, z}}, ToolAction::cut);
            simulation.step();
        }
        EXPECT_GT(simulation.cut_statistics().copies, copies);
        press(ToolAction::idle);
        simulation.move(blade, {.position = {x, 0, 5}}, ToolAction::idle);
        simulation.step();
        const Point before = momentum();
        for (int step = 0; step < 3; ++step) simulation.step();
        const Point after = momentum();
        for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(after[axis], before[axis], lost) << axis;
    }
}

TEST(SimulatedCut, AfterItTheLoadsAreThoseOfTheSceneAndContactsLeaveNothingBehind) {
    for (const double room : {0.0, 0.5}) {
        for (const bool is_pushed : {false, true}) expect_rest_of_forces_to_end(is_pushed, room);
    }
}

}  // namespace
}  // namespace lancet::runtime
