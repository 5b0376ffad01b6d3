// What bodies carry: points, surfaces, and what tools and frames see of them.
#include "lancet/runtime/simulate/surface.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/runtime/simulate/simulated_bars.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/embed/embedding.hpp"
#include "lancet/mesh/surface/vertex_normals.hpp"

namespace lancet::runtime {
namespace {

using namespace test;

std::vector<Point> random_points(std::size_t count, std::mt19937_64& random) {
    std::uniform_real_distribution<double> coordinate(-1, 1);
    std::vector<Point> points(count);
    for (Point& point : points) point = {coordinate(random), coordinate(random), coordinate(random)};
    return points;
}

TEST(CarriedPoints, AreWhereTheirWeightsPutThem) {
    std::mt19937_64 random(5);
    const std::vector<Point> nodes = random_points(200, random);
    std::uniform_int_distribution<std::int32_t> node(0, 199), kind(1, 4);
    std::uniform_real_distribution<double> weight(-0.5, 1.5);
    CarriedPoints points;
    // More than a block of each kind, in mixed order.
    for (int k = 0; k < 6000; ++k) {
        mesh::MaterialPoint point{.part = k};
        const int corners = kind(random), first = kind(random);
        double rest = 1;
        for (int corner = 1; corner < corners; ++corner) {
            rest -= point.weights[static_cast<std::size_t>((first + corner) % 4)] = weight(random);
        }
        point.weights[static_cast<std::size_t>(first % 4)] = rest;
        points.add(point, {node(random), node(random), node(random), node(random)});
    }
    std::vector<Point> expected(points.size());
    mesh::place(points.nodes, points.weights, nodes, expected);
    for (const SchedulerKind scheduler : available_schedulers()) {
        std::vector<Point> found(3, Point{7, 7, 7});
        points.place(*make_scheduler(scheduler, 2), nodes, found);
        EXPECT_TRUE(found == expected) << to_string(scheduler);
    }
}

TEST(CarriedPoints, ThatAreNodesDoNotAskOtherNodes) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    CarriedPoints points;
    points.add({.part = 0, .weights = {0, 1, 0, 0}}, {0, 1, 0, 0});
    points.add({.part = 0, .weights = {0, 0.5, 0, 0.5}}, {0, 1, 0, 2});
    std::vector<Point> found;
    points.place(*make_scheduler(SchedulerKind::serial, 1), std::vector<Point>{{nan, nan, nan}, {1, 2, 3}, {3, 2, 1}},
                 found);
    EXPECT_EQ(found, (std::vector<Point>{{1, 2, 3}, {2, 2, 2}}));
}

double distance(const Point& p, const Point& q) {
    return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

TEST(SurfaceEvaluator, FindsTheNormalsOfTheSurfaceOnEveryScheduler) {
    const mesh::TetMesh mesh = mesh::box({.cells = {20, 8, 8}, .size = {2, 0.8, 0.8}});
    const CarriedSurface surface = boundary_surface(mesh);
    ASSERT_GT(surface.vertices.size(), 512U) << "a block is full";
    std::mt19937_64 random(6);
    std::vector<Point> nodes = random_points(mesh.nodes().size(), random);
    for (std::size_t node = 0; node < nodes.size(); ++node) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            nodes[node][axis] = mesh.nodes()[node][axis] + 0.03 * nodes[node][axis];
        }
    }
    SurfaceShape shape;
    surface.vertices.place(*make_scheduler(SchedulerKind::serial, 1), nodes, shape.positions);
    // What float cannot tell: triangles that have collapsed to a line, and a vertex that is nowhere.
    for (const std::int32_t corner : surface.triangles[100]) {
        shape.positions[static_cast<std::size_t>(corner)] = {1, 1 + 0.01 * corner, 1};
    }
    shape.positions[300] = {0, std::numeric_limits<double>::quiet_NaN(), 0};
    std::vector<Point> expected(shape.positions.size());
    mesh::vertex_normals(surface.corners, shape.positions, 0, expected.size(), expected);
    std::vector<bool> is_near_nothing(expected.size(), false);
    for (const mesh::Triangle& t : surface.triangles) {
        if (std::ranges::find(t, 300) == t.end()) continue;
        for (const std::int32_t corner : t) is_near_nothing[static_cast<std::size_t>(corner)] = true;
    }
    for (const kernels::InstructionSet set : kernels::compiled_instruction_sets()) {
        if (!kernels::is_executable(set)) continue;
        SurfaceEvaluator on_one_thread(set);
        on_one_thread.find_normals(*make_scheduler(SchedulerKind::serial, 1), surface, shape);
        const std::vector<Point> normals = shape.normals;
        for (std::size_t vertex = 0; vertex < expected.size(); ++vertex) {
            EXPECT_LT(distance(normals[vertex], expected[vertex]), 1e-5) << vertex << to_string(set);
            if (!is_near_nothing[vertex]) continue;
            EXPECT_EQ(normals[vertex], expected[vertex]) << vertex << to_string(set);
        }
        for (const SchedulerKind kind : available_schedulers()) {
            SurfaceEvaluator evaluator(set);
            evaluator.find_normals(*make_scheduler(kind, 3), surface, shape);
            EXPECT_TRUE(shape.normals == normals) << to_string(kind);
        }
    }
}

// With collisions all nodes are looked at, without them those of the surface.
TEST(SurfaceSnapshots, ShowWhereTheNodesOfTheSurfaceAre) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    const CarriedSurface surface = boundary_surface(bar("bar").scene.mesh);
    const std::span<const std::int32_t> nodes = surface.vertices.as_nodes();
    ASSERT_EQ(nodes.size(), surface.vertices.size());
    std::vector<Point> alone;
    for (const int bodies : {1, 2}) {
        Simulation simulation(*scheduler, {.time_step = time_step, .frame_rate = 1 / time_step});
        for (int body = 0; body < bodies; ++body)
            simulation.add_body(bar(std::to_string(body), true, {0, 5.0 * body, 0}));
        simulation.keep_surfaces();
        for (int step = 0; step < 5; ++step) simulation.step();
        simulation.finish();
        const auto shape = simulation.latest_surface(0);
        ASSERT_EQ(shape->positions.size(), nodes.size());
        for (std::size_t vertex = 0; vertex < nodes.size(); ++vertex) {
            EXPECT_EQ(shape->positions[vertex], simulation.body(0).body().position(nodes[vertex])) << vertex;
        }
        if (bodies == 1) alone = shape->positions;
        EXPECT_EQ(shape->positions, alone);
    }
}

TEST(CarriedPoints, AreNodesOnlyWhereAllOfThemAre) {
    CarriedPoints points;
    EXPECT_TRUE(points.as_nodes().empty());
    points.add({.part = 0, .weights = {0, 1, 0, 0}}, {4, 5, 6, 7});
    points.add({.part = 1, .weights = {1, 0, 0, 0}}, {9, 5, 6, 7});
    EXPECT_THAT(points.as_nodes(), testing::ElementsAre(5, 9));
    points.add({.part = 1, .weights = {0.5, 0.5, 0, 0}}, {9, 5, 6, 7});
    EXPECT_TRUE(points.as_nodes().empty());
    points.add({.part = 1, .weights = {1, 0, 0, 0}}, {9, 5, 6, 7});
    EXPECT_TRUE(points.as_nodes().empty());
}

TEST(TouchableSurface, FindsTheContactsThatAllTrianglesHave) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    const mesh::TetMesh mesh = mesh::box({.cells = {8, 4, 4}, .size = {0.8, 0.4, 0.4}});
    const CarriedSurface surface = boundary_surface(mesh);
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> coordinate(-0.2, 1);
    TouchableSurface touchable;
    int touching = 0;
    for (int round = 0; round < 300; ++round) {
        std::vector<Point> nodes = random_points(mesh.nodes().size(), random);
        for (std::size_t node = 0; node < nodes.size(); ++node) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                nodes[node][axis] = mesh.nodes()[node][axis] + 0.02 * nodes[node][axis];
            }
        }
        // Now and then a vertex that has gone astray.
        if (round % 5 == 0) nodes[7][1] = std::numeric_limits<double>::quiet_NaN();
        if (round % 5 == 1) nodes[9][0] = std::numeric_limits<double>::infinity();
        ToolMotion motion;
        const ToolShape shape = CapsuleTool{.start = {0, 0, -0.1}, .end = {0, 0, 0.2}, .radius = 0.05};
        const Pose from{.position = {coordinate(random), coordinate(random), coordinate(random)}};
        const Pose to{.position = {coordinate(random), coordinate(random), coordinate(random)}};
        motion.set(shape, round % 2 == 0 ? to : from, to);
        std::vector<Point> positions;
        surface.vertices.place(*scheduler, nodes, positions);
        touchable.update(positions);
        const std::span<const ToolContact> found = touchable.contacts(surface, motion);

        std::vector<Box> boxes(surface.triangles.size());
        boxes_around<mesh::Triangle>(positions, surface.triangles, 0, boxes);
        const auto all = make_broad_phase(BroadPhaseKind::brute_force);
        all->build(boxes);
        ToolContactFinder finder;
        std::vector<ToolContact> expected;
        finder.find(*all, positions, surface.triangles, motion, expected);
        ASSERT_EQ(found.size(), expected.size()) << round;
        touching += expected.empty() ? 0 : 1;
        for (std::size_t k = 0; k < expected.size(); ++k) {
            EXPECT_EQ(found[k].triangle, expected[k].triangle) << round;
            EXPECT_EQ(found[k].place, expected[k].place) << round;
            EXPECT_EQ(found[k].normal, expected[k].normal) << round;
            EXPECT_EQ(found[k].depth, expected[k].depth) << round;
        }
    }
    EXPECT_GT(touching, 100);
}

TEST(Frames, DoNotChangeWhileSomebodyLooksAtThem) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler, {.time_step = time_step, .frame_rate = 50});
    simulation.add_body(bar("bar"));
    simulation.add_body(bar("other", true, {0, 1, 0}));
    std::atomic<int> seen{0}, may_end{0};
    simulation.observe_frames([&](const Frame& frame) {
        ASSERT_EQ(frame.bodies.size(), 2U);
        const std::int64_t step = frame.bodies.front().step;
        const std::vector<Point> positions = frame.bodies[0].positions;
        ++seen;
        seen.notify_all();
        may_end.wait(0);
        EXPECT_EQ(frame.step, step);
        int bodies = 0;
        for (const SurfaceShape& shape : frame.bodies) {
            EXPECT_EQ(shape.step, step);
            EXPECT_EQ(shape.positions.size(), shape.normals.size());
            ++bodies;
        }
        EXPECT_EQ(bodies, 2);
        EXPECT_EQ(frame.bodies[0].positions, positions);
    });
    simulation.step();
    seen.wait(0);
    // More steps than there are slots for surfaces, and other readers: the frame's stay as they are.
    std::vector<SurfaceSnapshots::Reader> readers;
    for (int step = 0; step < 20; ++step) {
        if (step < 3) readers.push_back(simulation.latest_surface(0));
        simulation.step();
    }
    EXPECT_EQ(simulation.latest_surface(0)->step, 20);
    may_end = 1;
    may_end.notify_all();
    simulation.finish();
}

TEST(SimulatedBody, LoadsOfNodesAreThoseOfAllNodes) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    const BodyDefinition definition = bar("bar");
    const auto all = make_body(definition.scene, definition.settings, *scheduler);
    const auto single = make_body(definition.scene, definition.settings, *scheduler);
    std::vector<Point> loads(all->nodes(), Point{});
    loads[20] = {0.1, 0.2, 0.3};
    loads[30] = {0, -1, 0};
    all->set_loads(loads);
    single->set_load(20, {5, 5, 5});
    single->set_load(30, loads[30]);
    single->set_load(20, loads[20]);
    std::vector<Point> expected(all->nodes()), found(all->nodes());
    for (int step = 0; step < 3; ++step) {
        all->step(*scheduler);
        single->step(*scheduler);
    }
    all->positions(expected);
    single->positions(found);
    EXPECT_EQ(found, expected);
    EXPECT_THROW(single->set_load(-1, {}), Error);
    EXPECT_THROW(single->set_load(static_cast<std::int32_t>(single->nodes()), {}), Error);
    EXPECT_THROW(single->set_load(20, {0, NAN, 0}), Error);
}

}  // namespace
}  // namespace lancet::runtime
