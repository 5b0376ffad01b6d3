// What tools and bodies do to each other.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/runtime/simulate/simulated_bars.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {
namespace {

using namespace test;

BodyDefinition block(const std::string& name, const std::array<int, 3>& cells, const Point& origin) {
    BodyDefinition definition{.name = name};
    Point size{};
    for (std::size_t axis = 0; axis < 3; ++axis) size[axis] = 0.1 * cells[axis];
    definition.scene.mesh = mesh::box({.cells = cells, .size = size, .origin = origin});
    definition.scene.materials[0].young_modulus = 1e5;
    definition.settings.time_step = 0.005;
    return definition;
}

TEST(SimulatedContact, ATouchPushesAndIsFeltTheOtherWay) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler, {.time_step = 0.005, .gravity = {0, 0, 0}});
    BodyDefinition definition = bar("bar");
    definition.settings.time_step = 0.005;
    simulation.add_body(std::move(definition));
    ToolDefinition probe{.name = "probe",
                         .shape = CapsuleTool{.start = {0, 0, -0.3}, .end = {0, 0, 0.3}, .radius = 0.05}};
    const int tool = simulation.add_tool(probe);
    const Pose pressed{.position = {0.75, 0.22, 0.1}};
    simulation.play(tool, resampled(ToolPath{{.time = 0, .pose = {.position = {0.75, 0.30, 0.1}}},
                                             {.time = 0.5, .pose = pressed},
                                             {.time = 5, .pose = pressed}},
                                    0.005));
    for (int step = 0; step < 1000; ++step) simulation.step();
    // At rest the tool carries what the bar pushes back with, and the forces on both are opposite: the elastic forces
    // on the free nodes are in balance with the contacts.
    const Wrench felt = simulation.force(tool, pressed);
    EXPECT_GT(felt.force[1], 0.5);
    std::vector<Point> elastic(simulation.body(0).body().nodes());
    simulation.body(0).body().elastic_forces(*scheduler, elastic);
    Point sum{};
    for (const Point& force : elastic) {
        for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += force[axis];
    }
    // The bar still swings a little: its inertia is the difference.
    EXPECT_NEAR(sum[1], felt.force[1], 0.02 * felt.force[1]);
    EXPECT_EQ(simulation.force(tool, {.position = {0.75, 0.5, 0.1}}).force, (Point{}));
    const Point deeper = simulation.force(tool, {.position = {0.75, 0.21, 0.1}}).force;
    EXPECT_GT(deeper[1], felt.force[1]);
}

TEST(SimulatedContact, AGrabTakesTheBodyAlongAndLetsGo) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler, {.time_step = 0.005, .gravity = {0, 0, 0}});
    BodyDefinition definition = bar("bar", false);
    definition.settings.time_step = 0.005;
    simulation.add_body(std::move(definition));
    ToolDefinition hand{.name = "hand", .shape = SphereTool{.radius = 0.05}, .grab_distance = 0.08};
    const int tool = simulation.add_tool(hand);
    simulation.play(tool,
                    resampled(ToolPath{{.time = 0, .pose = {.position = {0.4, 0.2, 0.1}}, .action = ToolAction::grab},
                                       {.time = 2, .pose = {.position = {0.4, 1.2, 0.1}}, .action = ToolAction::grab},
                                       {.time = 3, .pose = {.position = {0.4, 1.2, 0.1}}, .action = ToolAction::grab}},
                              0.005));
    const auto height = [&] {
        double sum = 0;
        const auto all = positions(simulation.body(0));
        for (const Point& at : all) sum += at[1] / static_cast<double>(all.size());
        return sum;
    };
    EXPECT_NEAR(height(), 0.1, 1e-12);
    for (int step = 0; step < 600; ++step) simulation.step();
    EXPECT_NEAR(height(), 1.1, 0.1);
    simulation.play(tool, {{.time = 3.0, .pose = {.position = {0.4, 3, 0.1}}, .action = ToolAction::touch}});
    for (int step = 0; step < 10; ++step) simulation.step();
    EXPECT_TRUE(simulation.latest_forces(tool)->anchors.empty());
}

TEST(SimulatedContact, ABodyAtRestSleepsUntilItIsTouched) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler, {.time_step = time_step, .sleep = {.speed = 1e-3, .after = 0.2}});
    BodyDefinition definition = bar("bar");
    definition.scene.rayleigh_mass = 20;
    simulation.add_body(std::move(definition));
    ToolDefinition probe{.name = "probe", .shape = SphereTool{.radius = 0.08}};
    const int tool = simulation.add_tool(probe);
    simulation.play(tool, {{.time = 0, .pose = {.position = {0.8, 2, 0.1}}}});
    int step = 0;
    for (; step < 1000 && !simulation.body(0).is_asleep(); ++step) simulation.step();
    ASSERT_TRUE(simulation.body(0).is_asleep());
    const auto asleep = positions(simulation.body(0));
    const std::int64_t steps_of_body = simulation.body(0).body().totals().steps;
    for (int k = 0; k < 10; ++k) simulation.step();
    EXPECT_EQ(positions(simulation.body(0)), asleep);
    EXPECT_EQ(simulation.body(0).body().totals().steps, steps_of_body);

    simulation.play(tool,
                    {{.time = simulation.time() + time_step, .pose = {.position = {0.75, asleep.back()[1], 0.1}}}});
    for (int k = 0; k < 4; ++k) simulation.step();
    EXPECT_FALSE(simulation.body(0).is_asleep());
    EXPECT_NE(positions(simulation.body(0)), asleep);
}

TEST(SimulatedContact, ABodyWakesByALoad) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler,
                          {.time_step = time_step, .gravity = {0, 0, 0}, .sleep = {.speed = 1e-3, .after = 0.1}});
    simulation.add_body(bar("bar"));
    for (int step = 0; step < 10; ++step) simulation.step();
    ASSERT_TRUE(simulation.body(0).is_asleep());
    const auto asleep = positions(simulation.body(0));
    std::vector<Point> loads(asleep.size());
    loads.back() = {0, 50, 0};
    simulation.body(0).set_loads(loads);
    for (int step = 0; step < 5; ++step) simulation.step();
    EXPECT_FALSE(simulation.body(0).is_asleep());
    EXPECT_GT(positions(simulation.body(0)).back()[1], asleep.back()[1]);
    EXPECT_THROW(simulation.body(0).set_loads(std::span(loads).first(3)), Error);
}

TEST(SimulatedContact, BodiesPushEachOtherApart) {
    for (const bool overlap : {true, false}) {
        const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
        Simulation simulation(*scheduler, {.time_step = 0.005, .overlap = overlap});
        BodyDefinition falling = block("falling", {3, 3, 3}, {0.163, 0.25, 0.157});
        falling.scene.rayleigh_mass = 1;
        simulation.add_body(std::move(falling));
        BodyDefinition table = block("table", {6, 2, 6}, {0, 0, 0});
        const auto nodes = table.scene.mesh.node_set("y_min");
        table.scene.fixed_nodes.assign(nodes.begin(), nodes.end());
        simulation.add_body(std::move(table));
        EXPECT_NE(simulation.graph().to_dot().find("\"body collision\""), std::string::npos);
        double lowest = 1;
        for (int step = 0; step < 600; ++step) {
            simulation.step();
            const auto now = positions(simulation.body(0));
            for (const Point& at : now) lowest = std::min(lowest, at[1]);
        }
        // It falls by 0.05 m, and without contact would by 44 m. Nodes of 0.4 kg on springs of m / (4 h^2) carry the
        // weight of 27 kg at a depth of millimetres; the fall adds to it, and the table gives way.
        EXPECT_GT(lowest, 0.1);
        double mean = 0;
        for (const Point& at : positions(simulation.body(0))) mean += at[1] / 64;
        EXPECT_NEAR(mean, 0.35, 0.06) << "it lies on the table";
    }
}

TEST(SimulatedContact, BodiesThatCollideKeepTheirMomentum) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler, {.time_step = 0.005, .gravity = {0, 0, 0}});
    simulation.add_body(block("left", {3, 3, 3}, {0, 0, 0}));
    simulation.add_body(block("right", {3, 3, 3}, {0.32, 0.02, 0.03}));
    std::vector<Point> velocities(64, Point{1, 0.1, 0});
    simulation.body(0).body().set_velocities(velocities);
    const auto momentum = [&] {
        Point sum{};
        for (int body = 0; body < 2; ++body) {
            simulation.body(body).body().velocities(velocities);
            for (std::size_t node = 0; node < velocities.size(); ++node) {
                const double mass = simulation.body(body).body().nodal_mass(static_cast<std::int32_t>(node));
                for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += mass * velocities[node][axis];
            }
        }
        return sum;
    };
    const Point before = momentum();
    for (int step = 0; step < 100; ++step) simulation.step();
    const Point after = momentum();
    // 27 kg at 1 m / s. The solves are in float and end at their tolerance.
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(after[axis], before[axis], 1e-3 * before[0]);
    double right = 0;
    simulation.body(1).body().velocities(velocities);
    for (const Point& v : velocities) right += v[0] / 64;
    EXPECT_GT(right, 0.3) << "the right one has been hit";
}

TEST(SimulatedContact, AToolThatIsPutElsewhereStartsThere) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler, {.time_step = time_step});
    simulation.add_body(bar("bar"));
    const int tool = simulation.add_tool({.name = "probe", .shape = SphereTool{.radius = 0.001}});
    simulation.play(tool, {{.time = 0.02, .pose = {.position = {0, 1e6, 0}}}, {.time = 0.06, .pose = {}}});
    for (int step = 0; step < 5; ++step) EXPECT_NO_THROW(simulation.step());
}

TEST(SimulatedContact, AnIdleToolGoesThroughEverything) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler, {.time_step = time_step, .gravity = {0, 0, 0}});
    simulation.add_body(bar("bar"));
    const int tool = simulation.add_tool({.name = "probe", .shape = SphereTool{.radius = 0.1}});
    const auto before = positions(simulation.body(0));
    simulation.play(tool, {{.time = 0.02, .pose = {.position = {0.7, 0.1, 0.1}}, .action = ToolAction::idle}});
    for (int step = 0; step < 5; ++step) simulation.step();
    EXPECT_EQ(positions(simulation.body(0)), before);
    simulation.play(tool, {{.time = 0.12, .pose = {.position = {0.7, 0.15, 0.1}}}});
    for (int step = 0; step < 5; ++step) simulation.step();
    EXPECT_NE(positions(simulation.body(0)), before);
}

}  // namespace
}  // namespace lancet::runtime
