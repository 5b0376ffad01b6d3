// Islands of a body that sleep and wake on their own.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/runtime/simulate/simulated_bars.hpp"
#include <gtest/gtest.h>

#include "lancet/runtime/cut/cuttable_body.hpp"

namespace lancet::runtime {
namespace {

using namespace test;

constexpr double length = 2.4, floor_height = -0.5;

/// A stiff bar of 2.4 x 0.4 x 0.4 m over a floor, of some ten blocks, that comes to rest soon.
BodyDefinition long_bar(double room = 0.5, mesh::Fronts fronts = mesh::Fronts::sharp) {
    BodyDefinition definition{.name = "bar"};
    definition.scene.mesh = mesh::box({.cells = {24, 4, 4}, .size = {length, 0.4, 0.4}});
    definition.scene.materials[0] = {.young_modulus = 5e7, .poisson_ratio = 0.3, .density = 1000};
    definition.scene.rayleigh_mass = 20;
    definition.scene.floor = Floor{.point = {0, floor_height, 0}, .normal = {0, 1, 0}};
    const auto nodes = definition.scene.mesh.node_set("x_min");
    definition.scene.fixed_nodes.assign(nodes.begin(), nodes.end());
    definition.settings.time_step = time_step;
    definition.can_be_cut = true;
    definition.cuts = {.fronts = fronts, .room = room};
    return definition;
}

/// Cuts through a body at some x with one stroke.
void sever(SimulatedBody& body, Scheduler& scheduler, double x) {
    Blade blade;
    for (const double z : {-0.3, 0.7}) body.draw(blade, scheduler, {x, -0.3, z}, {x, 0.7, z});
}

int island_at(SimulatedBody& body, const Point& rest) {
    const auto nodes = body.cuttable()->mesh().mesh().nodes();
    const auto nearest = std::ranges::min_element(
        nodes, {}, [&](const Point& at) { return std::hypot(at[0] - rest[0], at[1] - rest[1], at[2] - rest[2]); });
    return body.island_of(static_cast<std::int32_t>(nearest - nodes.begin()));
}
int held_part(SimulatedBody& body) {
    return island_at(body, {0, 0.2, 0.2});
}
int severed_part(SimulatedBody& body) {
    return island_at(body, {length, 0.2, 0.2});
}

std::vector<Point> positions_of_island(SimulatedBody& body, int island) {
    std::vector<Point> result;
    for (std::int32_t node = 0; node < static_cast<std::int32_t>(body.body().nodes()); ++node) {
        if (body.island_of(node) == island) result.push_back(body.body().position(node));
    }
    return result;
}

/// Steps until all that is asked for sleeps.
void step_until_asleep(Simulation& simulation, const std::function<bool()>& is_asleep) {
    for (int step = 0; step < 500 && !is_asleep(); ++step) simulation.step();
    ASSERT_TRUE(is_asleep());
}

constexpr SleepOptions sleep{.speed = 1e-3, .after = 0.1};

/// A bar that has been cut in two; both pieces sleep, one in its clamp, one on the floor.
struct Severed {
    std::unique_ptr<Scheduler> scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation{*scheduler, {.time_step = time_step, .sleep = sleep}};
    SimulatedBody& body;
    int held = -1, severed = -1;

    explicit Severed(BodyDefinition definition = long_bar())
        : body(simulation.body(simulation.add_body(std::move(definition)))) {
        EXPECT_EQ(body.islands(), 1);
        sever(body, *scheduler, 1.25);
        EXPECT_EQ(body.islands(), 2);
        held = held_part(body);
        severed = severed_part(body);
        EXPECT_NE(held, severed);
        step_until_asleep(simulation, [&] { return body.is_asleep(); });
        EXPECT_LT(positions_of_island(body, severed).back()[1], 0.1) << "it has fallen";
    }
};

TEST(IslandSleep, NobodyKnowsIslandsWhereNothingMaySleep) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler, {.time_step = time_step});
    SimulatedBody& body = simulation.body(simulation.add_body(long_bar()));
    EXPECT_EQ(body.islands(), 0);
    sever(body, *scheduler, 1.25);
    EXPECT_EQ(body.islands(), 0);
    body.wake();
    body.set_loads(std::vector<Point>(body.body().nodes(), Point{0, -1, 0}));
    for (int step = 0; step < 3; ++step) simulation.step();
    EXPECT_EQ(body.body().totals().steps, 3);
    EXPECT_FALSE(body.is_asleep());
}

TEST(IslandSleep, ALoadWakesItsIslandAlone) {
    Severed scene;
    SimulatedBody& body = scene.body;
    const std::int64_t steps = body.body().totals().steps;
    scene.simulation.step();
    EXPECT_EQ(body.body().totals().steps, steps) << "what sleeps as a whole is not stepped";
    for (const auto& [wakes, sleeps] : {std::pair{scene.held, scene.severed}, {scene.severed, scene.held}}) {
        const auto asleep = positions_of_island(body, sleeps), rested = positions_of_island(body, wakes);
        std::vector<Point> loads(body.body().nodes(), Point{});
        const auto far_end = [&](std::int32_t node) { return body.island_of(node) == wakes; };
        std::int32_t loaded = 0;
        for (std::int32_t node = 0; node < static_cast<std::int32_t>(loads.size()); ++node) {
            if (far_end(node)) loaded = node;
        }
        loads[static_cast<std::size_t>(loaded)] = {0, 3000, 0};
        body.set_loads(loads);
        EXPECT_FALSE(body.is_asleep(wakes));
        EXPECT_TRUE(body.is_asleep(sleeps));
        EXPECT_FALSE(body.is_asleep());
        const std::int64_t left_out = body.body().totals().sleeping_blocks;
        for (int step = 0; step < 4; ++step) scene.simulation.step();
        EXPECT_GE(body.body().totals().sleeping_blocks - left_out, 4 * (body.body().blocks() / 2 - 2));
        EXPECT_NE(positions_of_island(body, wakes), rested);
        EXPECT_EQ(positions_of_island(body, sleeps), asleep);
        body.set_loads(loads);
        EXPECT_TRUE(body.is_asleep(sleeps)) << "the loads are as they were";
        body.set_loads(std::vector<Point>(loads.size()));
        step_until_asleep(scene.simulation, [&] { return body.is_asleep(); });
    }
    body.wake();
    EXPECT_FALSE(body.is_asleep(scene.held));
    EXPECT_FALSE(body.is_asleep(scene.severed));
}

TEST(IslandSleep, ACutWakesWhatItTouches) {
    for (const double room : {0.0, 0.5}) {
        for (const mesh::Fronts fronts : {mesh::Fronts::sharp, mesh::Fronts::blended}) {
            SCOPED_TRACE(testing::Message() << room << ", " << (fronts == mesh::Fronts::sharp ? "sharp" : "blended"));
            Severed scene(long_bar(room, fronts));
            SimulatedBody& body = scene.body;
            const auto asleep = positions_of_island(body, scene.severed);
            sever(body, *scene.scheduler, 0.65);
            ASSERT_EQ(body.islands(), 3);
            EXPECT_TRUE(body.is_asleep(severed_part(body)));
            EXPECT_FALSE(body.is_asleep(held_part(body)));
            EXPECT_FALSE(body.is_asleep(island_at(body, {1, 0.2, 0.2})));
            const auto falling = [&] {
                double height = 0;
                const auto places = positions_of_island(body, island_at(body, {1, 0.2, 0.2}));
                for (const Point& at : places) height += at[1] / static_cast<double>(places.size());
                return height;
            };
            const double height = falling();
            for (int step = 0; step < 5; ++step) scene.simulation.step();
            EXPECT_EQ(positions_of_island(body, severed_part(body)), asleep);
            EXPECT_LT(falling(), height - 0.02);
            EXPECT_EQ(body.body().totals().coarse_failures, 0);

            // A cut that ends within the sleeping one wakes it, too.
            Blade blade;
            for (const double z : {-0.3, 0.15}) {
                body.draw(blade, *scene.scheduler, {1.9, -0.8, z}, {1.9, 0.2, z});
            }
            EXPECT_EQ(body.islands(), 3);
            EXPECT_FALSE(body.is_asleep(severed_part(body)));
        }
    }
}

TEST(IslandSleep, ATouchWakesItsIslandAlone) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler, {.time_step = time_step, .sleep = sleep});
    SimulatedBody& body = simulation.body(simulation.add_body(long_bar()));
    const int tool = simulation.add_tool({.name = "probe", .shape = SphereTool{.radius = 0.08}});
    simulation.play(tool, {{.time = 0, .pose = {.position = {0.8, 5, 0.2}}}});
    sever(body, *scheduler, 1.25);
    body.renew_surface(false);
    step_until_asleep(simulation, [&] { return body.is_asleep(); });
    const int held = held_part(body), severed = severed_part(body);
    const auto asleep = positions_of_island(body, held);
    const double top = floor_height + 0.4;
    simulation.play(tool, {{.time = simulation.time() + time_step, .pose = {.position = {2.0, top + 0.05, 0.2}}}});
    for (int step = 0; step < 4; ++step) simulation.step();
    EXPECT_FALSE(body.is_asleep(severed));
    EXPECT_TRUE(body.is_asleep(held));
    EXPECT_EQ(positions_of_island(body, held), asleep);
}

TEST(IslandSleep, AnIslandThatFallsOnOneWakesIt) {
    // Two blocks in one mesh, one above the other, and a third beside them: nothing connects them.
    BodyDefinition definition{.name = "blocks"};
    mesh::TetMesh::Definition blocks;
    for (const Point& origin : {Point{0, 0, 0}, Point{0.05, 0.6, 0.05}, Point{1, 0, 0}}) {
        const auto block = mesh::box({.cells = {3, 3, 3}, .size = {0.3, 0.3, 0.3}, .origin = origin});
        const auto first = static_cast<std::int32_t>(blocks.nodes.size());
        blocks.nodes.insert(blocks.nodes.end(), block.nodes().begin(), block.nodes().end());
        for (mesh::Tetrahedron t : block.tetrahedra()) {
            for (std::int32_t& node : t) node += first;
            blocks.tetrahedra.push_back(t);
        }
    }
    for (std::int32_t node = 0; node < static_cast<std::int32_t>(blocks.nodes.size()); ++node) {
        if (blocks.nodes[static_cast<std::size_t>(node)][1] == 0) definition.scene.fixed_nodes.push_back(node);
    }
    definition.scene.mesh = mesh::TetMesh(std::move(blocks));
    definition.scene.materials[0] = {.young_modulus = 1e6, .poisson_ratio = 0.3, .density = 1000};
    definition.scene.rayleigh_mass = 10;
    definition.settings.time_step = 0.005;
    definition.collides_with_itself = true;
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    // What stands on the ground still shakes by gravity, which comes at once: it is at rest soon.
    Simulation simulation(*scheduler, {.time_step = 0.005, .sleep = {.speed = 0.02, .after = 0.04}});
    SimulatedBody& body = simulation.body(simulation.add_body(std::move(definition)));
    ASSERT_EQ(body.islands(), 3);
    int step = 0;
    for (; step < 40 && !(body.is_asleep(0) && body.is_asleep(2)); ++step) simulation.step();
    ASSERT_LT(step, 40);
    EXPECT_FALSE(body.is_asleep(1)) << "it falls";
    const auto lower = positions_of_island(body, 0), beside = positions_of_island(body, 2);
    for (; step < 200 && body.is_asleep(0); ++step) simulation.step();
    EXPECT_FALSE(body.is_asleep(0)) << "it has been hit";
    for (int more = 0; more < 5; ++more) simulation.step();
    EXPECT_NE(positions_of_island(body, 0), lower);
    EXPECT_TRUE(body.is_asleep(2));
    EXPECT_EQ(positions_of_island(body, 2), beside);
}

TEST(IslandSleep, WhatIsPrescribedKeepsItsIslandAwake) {
    BodyDefinition definition = long_bar();
    definition.scene.prescribed.push_back({.node = 60, .axis = 0, .displacement = [](double) { return 0.0; }});
    ASSERT_LT(definition.scene.mesh.nodes()[60][0], 1.2);
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler, {.time_step = time_step, .sleep = sleep});
    SimulatedBody& body = simulation.body(simulation.add_body(std::move(definition)));
    sever(body, *scheduler, 1.25);
    const int prescribed = body.island_of(60), other = severed_part(body);
    ASSERT_NE(prescribed, other);
    step_until_asleep(simulation, [&] { return body.is_asleep(other); });
    for (int step = 0; step < 50; ++step) simulation.step();
    EXPECT_FALSE(body.is_asleep(prescribed));
    EXPECT_TRUE(body.is_asleep(other));
}

TEST(IslandSleep, ChangesTheMotionOfOthersByNoMoreThanTheSolver) {
    for (const double room : {0.0, 0.5}) {
        for (const mesh::Fronts fronts : {mesh::Fronts::sharp, mesh::Fronts::blended}) {
            SCOPED_TRACE(testing::Message() << room << ", " << (fronts == mesh::Fronts::sharp ? "sharp" : "blended"));
            BodyDefinition definition = long_bar(room, fronts);
            definition.scene.rayleigh_mass = 0;
            definition.scene.floor.reset();
            definition.settings.scalar = ScalarMode::double_precision;
            definition.settings.conjugate_gradients = {.iterations = 2000, .tolerance = 1e-12};
            const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
            CuttableBody with(definition.scene, definition.settings, *scheduler, definition.cuts);
            CuttableBody without(definition.scene, definition.settings, *scheduler, definition.cuts);
            for (CuttableBody* body : {&with, &without}) {
                for (int step = 0; step < 3; ++step) body->step(*scheduler);
                body->cut(*scheduler, mesh::CutSurface::parallelogram({1.25, -1, -1}, {0, 3, 0}, {0, 0, 3}),
                          Configuration::rest);
                for (int step = 0; step < 3; ++step) body->step(*scheduler);
            }
            // Once the held part sleeps while the other falls, then the other way round.
            const std::vector<std::int32_t> component = with.components();
            const BodyState state = without.body().save();
            for (const std::int32_t sleeper : {component.front(), 1 - component.front()}) {
                with.body().restore(*scheduler, state);
                without.body().restore(*scheduler, state);
                std::vector<std::uint8_t> asleep;
                for (const std::int32_t of_node : component) asleep.push_back(of_node == sleeper ? 1 : 0);
                ASSERT_GT(std::ranges::count(asleep, 1), 100);
                ASSERT_GT(std::ranges::count(asleep, 0), 100);
                with.body().set_asleep(asleep);
                const auto nodes = static_cast<std::int32_t>(component.size());
                std::vector<Point> start(component.size()), a(start), b(start);
                with.body().positions(start);
                for (int step = 0; step < 10; ++step) {
                    with.step(*scheduler);
                    without.step(*scheduler);
                }
                with.body().positions(a);
                without.body().positions(b);
                double difference = 0, moved = 0;
                for (std::int32_t node = 0; node < nodes; ++node) {
                    const auto at = static_cast<std::size_t>(node);
                    for (std::size_t axis = 0; axis < 3; ++axis) {
                        if (asleep[at] != 0) {
                            EXPECT_EQ(a[at][axis], start[at][axis]);
                        } else {
                            difference = std::max(difference, std::abs(a[at][axis] - b[at][axis]));
                            moved = std::max(moved, std::abs(b[at][axis] - start[at][axis]));
                        }
                    }
                }
                EXPECT_GT(moved, sleeper == component.front() ? 1e-2 : 1e-4);
                EXPECT_LE(difference, 1e-8 * moved);
                EXPECT_GT(with.body().totals().sleeping_blocks, 0);
                EXPECT_EQ(without.body().totals().sleeping_blocks, 0);
            }
        }
    }
}

/// A bar that a blade severs and a probe pushes then, with sleep.
struct Played {
    std::vector<Point> positions{};
    std::vector<bool> asleep{};  ///< [step][first and last island]
    ToolPath knife{}, probe{};
};

Played play(Scheduler& scheduler, const Played* recorded) {
    Simulation simulation(scheduler, {.time_step = time_step, .sleep = sleep});
    SimulatedBody& body = simulation.body(simulation.add_body(long_bar()));
    const int knife = simulation.add_tool(
        {.name = "knife", .blade = std::array<Point, 2>{{{0, -0.5, 0}, {0, 0.5, 0}}}, .is_recorded = true});
    const int probe = simulation.add_tool({.name = "probe", .shape = SphereTool{.radius = 0.08}, .is_recorded = true});
    if (recorded != nullptr) {
        simulation.play(knife, recorded->knife);
        simulation.play(probe, recorded->probe);
    }
    Played played;
    for (int step = 0; step < 220; ++step) {
        if (recorded == nullptr) {
            const double z = std::min(-0.2 + 0.04 * step, 1.0);
            simulation.move(knife, {.position = {1.25, 0.2, z}}, z < 1 ? ToolAction::cut : ToolAction::idle);
            const double height = step < 180 ? 2 : 0.45;
            simulation.move(probe, {.position = {0.9, height, 0.2}}, ToolAction::touch);
        }
        simulation.step();
        played.asleep.push_back(body.is_asleep(0));
        played.asleep.push_back(body.is_asleep(body.islands() - 1));
    }
    played.positions = positions(body);
    played.knife = simulation.recorded(knife);
    played.probe = simulation.recorded(probe);
    return played;
}

TEST(IslandSleep, IsRepeatedToTheBitOnEveryScheduler) {
    const auto serial = make_scheduler(SchedulerKind::serial, 1);
    const Played first = play(*serial, nullptr);
    ASSERT_TRUE(first.asleep[2 * 179] && first.asleep[2 * 179 + 1]) << "both pieces sleep before the probe comes";
    ASSERT_TRUE(!first.asleep[first.asleep.size() - 2] && first.asleep.back()) << "it wakes the held one";
    for (const SchedulerKind kind : available_schedulers()) {
        for (const int threads : {1, 2, 3}) {
            const auto scheduler = make_scheduler(kind, threads);
            const Played again = play(*scheduler, &first);
            EXPECT_TRUE(again.positions == first.positions) << to_string(kind) << " " << threads;
            EXPECT_EQ(again.asleep, first.asleep) << to_string(kind) << " " << threads;
            if (kind == SchedulerKind::serial) break;
        }
    }
}

}  // namespace
}  // namespace lancet::runtime
