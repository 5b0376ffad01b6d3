// Runs and what is read off them.
#include "lancet/experiments/cutting/run.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "lancet/experiments/common/main.hpp"
#include "lancet/experiments/cutting/motion.hpp"

namespace lancet::experiments::cutting {
namespace {

Scenario short_scalpel(runtime::Scheduler& scheduler) {
    Scenario scenario = scalpel(true, scheduler);
    scenario.steps = 8;
    return scenario;
}

TEST(CuttingRun, CountsGrowWithTheCutAndTimesAreThoseOfTheCut) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    const Scenario scenario = short_scalpel(*scheduler);
    int observed = 0;
    const auto frames = run(scenario, interactive_settings({}, scenario.time_step), *scheduler,
                            [&](int step, const runtime::CuttableBody&) { EXPECT_EQ(step, observed++); });
    EXPECT_EQ(observed, scenario.steps + 1);
    ASSERT_EQ(static_cast<int>(frames.size()), scenario.steps);
    for (std::size_t k = 0; k < frames.size(); ++k) {
        EXPECT_EQ(frames[k].step, static_cast<int>(k) + 1);
        EXPECT_EQ(frames[k].cut.has_value(), static_cast<int>(k) >= scenario.strokes.front().step);
        EXPECT_EQ(frames[k].positions.size(), frames[k].mass.size());
        if (k > 0) {
            EXPECT_GE(frames[k].cut_elements, frames[k - 1].cut_elements);
            EXPECT_GE(frames[k].added_nodes, frames[k - 1].added_nodes);
        }
    }
    EXPECT_GT(frames.back().cut_elements, 0);
    EXPECT_GT(frames.back().cut->ms_geometry, 0);
}

TEST(CuttingRun, TheErrorAgainstItselfIsZeroAndThatOfAShiftIsItsLength) {
    Frame reference{.positions = {{0, 0, 0}, {1, 0, 2}}, .mass = {3, 1}};
    const std::vector<Point> rest{{0, 0, 0}, {1, 0, 0}};
    EXPECT_EQ(error_l2(reference, reference, rest), 0.0);
    Frame found = reference;
    found.positions[0][1] = 1;
    EXPECT_DOUBLE_EQ(*error_l2(found, reference, rest), std::sqrt(3.0 / 4.0));
    EXPECT_FALSE(error_l2(Frame{.positions = rest, .mass = {3, 1}}, Frame{.positions = rest, .mass = {3, 1}}, rest));
    found.positions.pop_back();
    EXPECT_THROW((void)error_l2(found, reference, rest), CheckFailed);
}

TEST(CuttingRun, TheConvergedRunDoesNotDependOnItsTolerance) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    const Scenario scenario = short_scalpel(*scheduler);
    runtime::Settings settings = converged_settings(scenario.time_step, kernels::active_instruction_set());
    std::vector<Point> rest;
    const auto frames = run(scenario, settings, *scheduler,
                            [&](int, const runtime::CuttableBody& body) { rest = body.mesh().rest_positions(); });
    settings.newton_tolerance = 1e-11;
    settings.conjugate_gradients.tolerance = 1e-10;
    settings.matrix = runtime::OperatorKind::matrix_free;
    const auto finer = run(scenario, settings, *scheduler);
    // What a table shows is above 1e-5.
    EXPECT_LT(*error_l2(frames.back(), finer.back(), rest), 1e-6);
}

TEST(CuttingMotion, EveryRunIsBesideTheUncutOne) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    const Study study{.arithmetics = {{}, {.scalar = runtime::ScalarMode::double_precision}},
                      .lane_ratios = {{.both = 2}, {.both = 3}},
                      .repetitions = 2,
                      .is_quick = true,
                      .scheduler = scheduler.get()};
    Progress progress;
    const Scenario scenario = short_scalpel(*scheduler);
    const Motion motion = measure_motion(scenario, study, progress);
    ASSERT_EQ(motion.runs.size(), 6U);
    EXPECT_EQ(motion.frames.size(), 2U * 2 * 8);
    for (std::size_t k = 0; k < 6; ++k) {
        const Row& row = motion.runs[k];
        EXPECT_EQ(row.variant, (std::array{"uncut", "cut", "cut, blended front"}[k % 3]));
        EXPECT_EQ(row.scalar, k < 3 ? "float" : "double");
        EXPECT_EQ(row.cut_lane_ratio, k < 3 ? 2 : 3);
        EXPECT_EQ(row.cut_elements > 0, k % 3 > 0);
        EXPECT_EQ(row.step_ratio.has_value(), k % 3 > 0);
        EXPECT_EQ(row.ms_geometry.has_value(), k % 3 > 0);
        EXPECT_GT(*row.ms_step, 0);
        EXPECT_LT(*row.error_l2, 0.05);
        EXPECT_TRUE(row.noise_percent.has_value());
    }
}

}  // namespace
}  // namespace lancet::experiments::cutting
