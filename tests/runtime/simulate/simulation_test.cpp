#include "lancet/runtime/simulate/simulation.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "tests/runtime/simulate/simulated_bars.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/generate/box.hpp"

namespace lancet::runtime {
namespace {

using namespace test;

/// A tool that comes down on the end of the bar, cuts it through at x = 0.4 and grabs the end.
ToolPath busy_path() {
    ToolPath path;
    const auto add = [&](double time, const Point& at, ToolAction action) {
        path.push_back({.time = time, .pose = {.position = at}, .action = action});
    };
    add(0.0, {0.7, 0.40, 0.1}, ToolAction::touch);
    add(0.1, {0.7, 0.15, 0.1}, ToolAction::touch);
    add(0.2, {0.7, 0.15, 0.1}, ToolAction::grab);
    add(0.4, {0.8, 0.30, 0.1}, ToolAction::grab);
    add(0.42, {0.43, 0.5, 0.1}, ToolAction::touch);
    add(0.44, {0.43, 0.4, 0.1}, ToolAction::cut);
    add(0.8, {0.43, -0.5, 0.1}, ToolAction::cut);
    return resampled(path, time_step / 2);
}

std::set<std::string> tasks(Simulation& simulation) {
    std::set<std::string> names;
    const std::string dot = simulation.graph().to_dot();
    for (std::size_t at = dot.find("    \""); at != std::string::npos; at = dot.find("    \"", at + 1)) {
        const std::size_t end = dot.find('"', at + 5);
        names.insert(dot.substr(at + 5, end - at - 5));
    }
    return names;
}

TEST(Simulation, OfABodyAloneIsTheBody) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler, {.time_step = time_step});
    simulation.add_body(bar("bar"));
    BodyDefinition definition = bar("alone");
    const auto body = make_body(definition.scene, definition.settings, *scheduler);
    for (int step = 0; step < 20; ++step) {
        simulation.step();
        body->step(*scheduler);
    }
    std::vector<Point> expected(body->nodes());
    body->positions(expected);
    EXPECT_EQ(positions(simulation.body(0)), expected);
    EXPECT_EQ(simulation.steps(), 20);
    EXPECT_DOUBLE_EQ(simulation.time(), 20 * time_step);
}

TEST(Simulation, StepsABodySeveralTimesInAWorldStep) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler, {.time_step = 5 * time_step});
    simulation.add_body(bar("bar"));
    BodyDefinition definition = bar("alone");
    const auto body = make_body(definition.scene, definition.settings, *scheduler);
    simulation.step();
    for (int step = 0; step < 5; ++step) body->step(*scheduler);
    std::vector<Point> expected(body->nodes());
    body->positions(expected);
    EXPECT_EQ(positions(simulation.body(0)), expected);
    EXPECT_EQ(simulation.graph().size(), 20);
}

/// What a busy scene comes to.
struct Outcome {
    std::vector<std::vector<Point>> bodies;
    std::vector<Point> surface;
    std::vector<Point> normals;
    Wrench force;
    std::int64_t copies = 0;

    bool operator==(const Outcome& other) const {
        return bodies == other.bodies && surface == other.surface && normals == other.normals &&
               force.force == other.force.force && copies == other.copies;
    }
};

Outcome run_busy_scene(SchedulerKind kind, int threads, bool overlap) {
    const auto scheduler = make_scheduler(kind, threads);
    Simulation simulation(*scheduler, {.time_step = time_step, .overlap = overlap});
    BodyDefinition cut_bar = bar("cut");
    cut_bar.can_be_cut = true;
    simulation.add_body(std::move(cut_bar));
    simulation.add_body(bar("whole", true, {0, -0.5, 0}));
    const int tool = simulation.add_tool(knife());
    simulation.play(tool, busy_path());
    simulation.keep_surfaces();
    for (int step = 0; step < 45; ++step) simulation.step();
    simulation.finish();
    Outcome outcome;
    for (int body = 0; body < simulation.bodies(); ++body) outcome.bodies.push_back(positions(simulation.body(body)));
    outcome.surface = simulation.latest_surface(0)->positions;
    outcome.normals = simulation.latest_surface(0)->normals;
    outcome.force = simulation.force(tool, {.position = {0.43, 0.1, 0.1}});
    outcome.copies = simulation.cut_statistics().copies;
    return outcome;
}

TEST(Simulation, IsTheSameToTheBitOnEverySchedulerAndNumberOfThreads) {
    for (const bool overlap : {true, false}) {
        const Outcome expected = run_busy_scene(SchedulerKind::serial, 1, overlap);
        EXPECT_GT(expected.copies, 0);
        for (const SchedulerKind kind : available_schedulers()) {
            for (const int threads : {1, 2, 3}) {
                EXPECT_TRUE(run_busy_scene(kind, threads, overlap) == expected)
                    << to_string(kind) << ", " << threads << " threads, overlap " << overlap;
            }
        }
    }
}

TEST(Simulation, IsRepeatedToTheBitByARecordedTool) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    const auto make = [&](bool is_recorded) {
        auto simulation = std::make_unique<Simulation>(*scheduler, SimulationOptions{.time_step = time_step});
        BodyDefinition definition = bar("bar");
        definition.can_be_cut = true;
        simulation->add_body(std::move(definition));
        ToolDefinition tool = knife();
        tool.is_recorded = is_recorded;
        simulation->add_tool(tool);
        return simulation;
    };
    const auto live = make(true);
    const ToolPath path = busy_path();
    std::size_t next = 0;
    for (int step = 0; step < 45; ++step) {
        // As a hand would: now and then nothing, then several samples at once.
        if (step % 3 != 1) {
            for (; next < path.size() && path[next].time <= live->time() + time_step; ++next) {
                ASSERT_TRUE(live->move(0, path[next].pose, path[next].action));
            }
        }
        live->step();
    }
    const auto replay = make(false);
    replay->play(0, live->recorded(0));
    for (int step = 0; step < 45; ++step) replay->step();
    EXPECT_EQ(positions(replay->body(0)), positions(live->body(0)));
    EXPECT_GT(live->cut_statistics().copies, 0);
}

TEST(Simulation, HasNoTaskThatASceneDoesNotNeed) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler, {.time_step = time_step});
    simulation.add_body(bar("bar"));
    const std::set<std::string> bare{"bar: forces", "bar: matrix", "bar: solve", "bar: update"};
    EXPECT_EQ(tasks(simulation), bare);

    BodyDefinition explicit_bar = bar("explicit", true, {0, 1, 0});
    explicit_bar.settings.integrator = Integrator::central_differences;
    explicit_bar.settings.energy_safeguard = false;
    explicit_bar.settings.time_step = time_step / 32;
    Simulation without_system(*scheduler, {.time_step = time_step / 32});
    without_system.add_body(std::move(explicit_bar));
    EXPECT_EQ(tasks(without_system), std::set<std::string>{"explicit: step"});

    simulation.keep_surfaces();
    std::set<std::string> expected = bare;
    expected.insert({"bar: surface", "bar: snapshot"});
    EXPECT_EQ(tasks(simulation), expected);

    simulation.observe_frames([](const Frame&) {});
    expected.insert("frame");
    EXPECT_EQ(tasks(simulation), expected);

    ToolDefinition probe = knife();
    probe.blade.reset();
    simulation.add_tool(probe);
    expected.insert({"input", "tool collision", "contact forces", "force feedback"});
    EXPECT_EQ(tasks(simulation), expected);

    // A blade alone cuts nothing that cannot be cut.
    ToolDefinition blade = knife();
    blade.name = "blade";
    simulation.add_tool(blade);
    EXPECT_EQ(tasks(simulation), expected);
    BodyDefinition soft = bar("soft", true, {0, 2, 0});
    soft.can_be_cut = true;
    simulation.add_body(std::move(soft));
    expected.insert({"soft: forces", "soft: matrix", "soft: solve", "soft: update", "soft: snapshot", "soft: surface",
                     "soft: cut", "soft: surface renewal", "body collision"});
    EXPECT_EQ(tasks(simulation), expected);

    Simulation without_collision(*scheduler, {.time_step = time_step, .collision_rate = 0});
    without_collision.add_body(bar("bar"));
    without_collision.add_tool(probe);
    EXPECT_FALSE(tasks(without_collision).contains("tool collision"));
}

TEST(Simulation, FramesComeAtTheirRateAndShowConsistentStates) {
    for (const bool overlap : {true, false}) {
        const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
        Simulation simulation(
            *scheduler, {.time_step = time_step, .frame_rate = 12.5, .frames = FramePolicy::wait, .overlap = overlap});
        simulation.add_body(bar("bar"));
        std::vector<double> times;
        std::vector<std::int64_t> numbers;
        double lowest = 1;
        simulation.observe_frames([&](const Frame& frame) {
            times.push_back(frame.time);
            numbers.push_back(frame.number);
            ASSERT_EQ(frame.bodies.size(), 1U);
            const SurfaceShape& shape = frame.bodies.front();
            ASSERT_EQ(shape.positions.size(), shape.surface->vertices.size());
            for (const Point& normal : shape.normals) {
                EXPECT_NEAR(std::hypot(normal[0], normal[1], normal[2]), 1, 1e-12);
            }
            EXPECT_DOUBLE_EQ(shape.time, static_cast<double>(shape.step) * time_step);
            lowest = std::min_element(shape.positions.begin(), shape.positions.end(), [](auto& a, auto& b) {
                         return a[1] < b[1];
                     })->at(1);
        });
        for (int step = 0; step < 16; ++step) simulation.step();
        simulation.finish();
        const std::vector<double> expected =
            overlap ? std::vector{0.0, 0.08, 0.16, 0.24, 0.32} : std::vector{0.02, 0.08, 0.16, 0.24, 0.32};
        ASSERT_EQ(times.size(), expected.size());
        for (std::size_t k = 0; k < times.size(); ++k) EXPECT_NEAR(times[k], expected[k], 1e-12);
        EXPECT_EQ(numbers.back(), 4);
        EXPECT_LT(lowest, -0.01) << "the bar hangs";
        EXPECT_EQ(simulation.frame_statistics().dropped, 0);
        EXPECT_EQ(simulation.frame_statistics().observed, 5);
    }
}

TEST(Simulation, SlowObserversDelayNothingAndDropsAreCounted) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler, {.time_step = time_step, .frame_rate = 50});
    simulation.add_body(bar("bar"));
    std::atomic<bool> may_end{false};
    simulation.observe_frames([&](const Frame&) { may_end.wait(false); });
    for (int step = 0; step < 10; ++step) simulation.step();
    EXPECT_EQ(simulation.frame_statistics().due, 10);
    EXPECT_EQ(simulation.frame_statistics().dropped, 9);
    may_end = true;
    may_end.notify_all();
    simulation.finish();
    EXPECT_EQ(simulation.frame_statistics().observed, 2);
}

TEST(Simulation, WhatAnObserverThrowsIsThrownByAStep) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler, {.time_step = time_step, .frame_rate = 50});
    simulation.add_body(bar("bar"));
    simulation.observe_frames([](const Frame& frame) {
        if (frame.number == 0) throw Error("disk full");
    });
    simulation.step();
    EXPECT_THROW(simulation.finish(), Error);
    EXPECT_NO_THROW(simulation.step());
    EXPECT_NO_THROW(simulation.finish());
}

TEST(Simulation, ABladeCutsAMovingBodyInTwoAndTheSurfaceOpens) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler, {.time_step = time_step});
    BodyDefinition definition = bar("bar");
    definition.can_be_cut = true;
    simulation.add_body(std::move(definition));
    const int tool = simulation.add_tool(knife());
    simulation.keep_surfaces();
    simulation.play(
        tool, resampled(ToolPath{{.time = 0, .pose = {.position = {0.43, 0.6, 0.1}}, .action = ToolAction::cut},
                                 {.time = 0.4, .pose = {.position = {0.43, -0.6, 0.1}}, .action = ToolAction::cut}},
                        time_step));
    simulation.step();
    const auto whole = simulation.latest_surface(0)->surface;
    for (int step = 0; step < 60; ++step) simulation.step();
    simulation.finish();
    const auto surface = simulation.latest_surface(0);
    EXPECT_GT(surface->surface->version, whole->version);
    EXPECT_GT(std::ranges::count(surface->surface->is_wall, 1), 0);
    // The far piece falls; the near one hangs on the wall.
    double lowest = 0;
    for (const Point& at : surface->positions) lowest = std::min(lowest, at[1]);
    EXPECT_LT(lowest, -1);
    EXPECT_GT(simulation.cut_statistics().elements, 0);
}

TEST(Simulation, ToolsAreMovedAndSurfacesAskedForFromOtherThreads) {
    const auto scheduler = make_scheduler(available_schedulers().back(), 2);
    Simulation simulation(*scheduler, {.time_step = time_step, .frame_rate = 50});
    simulation.add_body(bar("bar"));
    const int tool = simulation.add_tool({.name = "probe", .shape = SphereTool{.radius = 0.05}});
    simulation.keep_surfaces();
    simulation.step();
    std::atomic<bool> ends{false};
    std::thread hand([&] {
        for (int k = 0; !ends; ++k) {
            simulation.move(tool, {.position = {0.7, 0.2 + 0.1 * std::sin(0.01 * k), 0.1}}, ToolAction::touch);
            const Point force = simulation.force(tool, {.position = {0.7, 0.2, 0.1}}).force;
            EXPECT_TRUE(std::isfinite(force[1]));
        }
    });
    std::thread eye([&] {
        std::int64_t last = 0;
        while (!ends) {
            const auto surface = simulation.latest_surface(0);
            ASSERT_TRUE(surface);
            EXPECT_GE(surface->step, last);
            last = surface->step;
            EXPECT_EQ(surface->positions.size(), surface->normals.size());
        }
    });
    for (int step = 0; step < 100; ++step) simulation.step();
    ends = true;
    hand.join();
    eye.join();
}

TEST(Simulation, AFineSurfaceIsCarriedAndOpens) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler, {.time_step = time_step});
    BodyDefinition definition = bar("bar");
    definition.can_be_cut = true;
    // A finer bar inside of the bar.
    const mesh::TetMesh inner =
        mesh::box({.cells = {24, 6, 6}, .size = {0.76, 0.16, 0.16}, .origin = {0.02, 0.02, 0.02}});
    mesh::TriangleMesh fine;
    const CarriedSurface boundary = boundary_surface(inner);
    for (std::size_t vertex = 0; vertex < boundary.vertices.size(); ++vertex) {
        for (std::size_t k = 0; k < 4; ++k) {
            if (boundary.vertices.weights[vertex][k] == 1) {
                fine.vertices.push_back(inner.nodes()[static_cast<std::size_t>(boundary.vertices.nodes[vertex][k])]);
            }
        }
    }
    fine.triangles = boundary.triangles;
    const std::size_t vertices = fine.vertices.size();
    ASSERT_EQ(vertices, boundary.vertices.size());
    definition.surface = fine;
    simulation.add_body(std::move(definition));
    const int tool = simulation.add_tool(knife());
    simulation.keep_surfaces();
    simulation.step();
    {
        const auto surface = simulation.latest_surface(0);
        ASSERT_EQ(surface->positions.size(), vertices);
        for (std::size_t vertex = 0; vertex < vertices; ++vertex) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                EXPECT_NEAR(surface->positions[vertex][axis], fine.vertices[vertex][axis], 1e-12);
            }
        }
    }
    simulation.play(
        tool, resampled(ToolPath{{.time = 0.02, .pose = {.position = {0.43, 0.6, 0.1}}, .action = ToolAction::cut},
                                 {.time = 0.4, .pose = {.position = {0.43, -0.6, 0.1}}, .action = ToolAction::cut}},
                        time_step));
    for (int step = 0; step < 30; ++step) simulation.step();
    simulation.finish();
    const auto surface = simulation.latest_surface(0);
    EXPECT_GT(surface->positions.size(), vertices);
    EXPECT_GT(std::ranges::count(surface->surface->is_wall, 1), 0);
}

TEST(Simulation, TellsObserversOfItsTasks) {
    struct Counter final : TaskObserver {
        void ended(int, std::string_view name, double begin, double end) noexcept override {
            EXPECT_LE(begin, end);
            if (name == "bar: solve") ++solves;
        }
        int solves = 0;
    } counter;
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    Simulation simulation(*scheduler, {.time_step = time_step});
    simulation.add_body(bar("bar"));
    simulation.observe_tasks(&counter);
    for (int step = 0; step < 3; ++step) simulation.step();
    EXPECT_EQ(counter.solves, 3);
    const auto statistics = simulation.task_statistics();
    ASSERT_EQ(statistics.size(), 4U);
    for (const TaskStatistics& task : statistics) {
        EXPECT_EQ(task.runs, 3);
        EXPECT_GE(task.seconds, task.longest);
    }
}

TEST(Simulation, BadInputIsAnErrorAndLosesNothing) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    EXPECT_THROW(Simulation(*scheduler, {.time_step = 0}), Error);
    EXPECT_THROW(Simulation(*scheduler, {.time_step = NAN}), Error);
    EXPECT_THROW(Simulation(*scheduler, {.frame_rate = -1}), Error);
    Simulation simulation(*scheduler, {.time_step = 0.03});
    try {
        simulation.add_body(bar("bar"));
        FAIL() << "0.03 s is no multiple of 0.02 s";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("whole multiple"));
    }
    EXPECT_EQ(simulation.bodies(), 0);
    EXPECT_THROW(simulation.body(0), Error);
    EXPECT_THROW(simulation.move(0, {}, ToolAction::touch), Error);
    EXPECT_THROW(simulation.add_tool({.name = "flat", .shape = SphereTool{.radius = 0}}), Error);
    const int tool = simulation.add_tool({.name = "probe"});
    EXPECT_THROW(simulation.add_tool({.name = "probe"}), Error);
    EXPECT_THROW(simulation.move(tool, {.position = {NAN, 0, 0}}, ToolAction::touch), Error);
    EXPECT_THROW(simulation.move(tool, {.orientation = {2, 0, 0, 0}}, ToolAction::touch), Error);
    EXPECT_THROW(simulation.play(tool, {{.time = 1}, {.time = 0}}), Error);
    for (int k = 0; k < 1024; ++k) EXPECT_TRUE(simulation.move(tool, {}, ToolAction::touch));
    EXPECT_FALSE(simulation.move(tool, {}, ToolAction::touch)) << "the queue is full";
    EXPECT_NO_THROW(simulation.step()) << "a world without bodies is a world";
    EXPECT_TRUE(simulation.move(tool, {}, ToolAction::touch));
}

}  // namespace
}  // namespace lancet::runtime
