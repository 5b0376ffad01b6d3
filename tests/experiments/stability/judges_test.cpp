// The criteria: what they let pass, and what they do not.
#include "lancet/experiments/stability/judges.hpp"

#include <gtest/gtest.h>

#include "lancet/experiments/stability/bodies.hpp"
#include "lancet/experiments/stability/report.hpp"
#include "lancet/experiments/stability/settings.hpp"
#include "lancet/mesh/generate/box.hpp"

namespace lancet::experiments::stability {
namespace {

runtime::Scene held_bar() {
    runtime::Scene scene;
    scene.mesh = mesh::box({.cells = {4, 2, 2}, .size = {1, 0.5, 0.5}});
    scene.fixed_nodes = nodes_at_end(scene.mesh, false);
    return scene;
}

TEST(StabilityJudges, AStableMotionPassesAndAnExplosionDoesNot) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    const runtime::Scene scene = held_bar();
    for (const auto model : {runtime::ElementModel::linear, runtime::ElementModel::corotational}) {
        Variant variant{.mass = runtime::MassKind::fraction, .model = model, .stepping = Stepping::explicit_element};
        runtime::Settings settings = settings_of(variant, scene, *scheduler, 0.04);
        Verdict stable;
        judge_motion(*make_body(scene, settings, *scheduler), *scheduler, motion_bound(scene, settings), 200, stable);
        EXPECT_TRUE(stable.survived) << stable.reason;
        settings.time_step = 1.01 * make_body(scene, settings, *scheduler)->critical_time_step(*scheduler);
        settings.force_time_step = true;
        Verdict unstable;
        judge_motion(*make_body(scene, settings, *scheduler), *scheduler, motion_bound(scene, settings), 1000,
                     unstable);
        EXPECT_FALSE(unstable.survived);
        EXPECT_NE(unstable.reason.find("energy"), std::string::npos);
    }
}

TEST(StabilityJudges, EnergyFromNowhereIsSeen) {
    // Random velocities make a single linearisation gain energy; with the safeguard it does not.
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    const runtime::Scene scene = held_bar();
    for (const bool safeguard : {true, false}) {
        runtime::Settings settings = settings_of({}, scene, *scheduler, 0.04);
        settings.energy_safeguard = safeguard;
        const auto body = make_body(scene, settings, *scheduler);
        Random random(5);
        std::vector<mesh::Point> velocities(body->nodes());
        for (auto& v : velocities) v = {random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-5, 5)};
        body->set_velocities(velocities);
        Verdict verdict;
        judge_motion(*body, *scheduler, motion_bound(scene, settings), 20, verdict);
        EXPECT_EQ(verdict.survived, safeguard) << verdict.reason;
    }
}

TEST(StabilityJudges, RoundingGrowsWithTheFlatnessOfElements) {
    Random random(1);
    runtime::Scene scene = held_bar();
    const double good = rounding_energy(scene, runtime::ScalarMode::single_precision);
    EXPECT_GT(good, 0);
    EXPECT_LT(rounding_energy(scene, runtime::ScalarMode::double_precision), 1e-12 * good);
    scene.mesh = with_bad_element(scene.mesh, 1e-5, random);
    EXPECT_GT(rounding_energy(scene, runtime::ScalarMode::single_precision), 100 * good);
}

TEST(StabilityJudges, AnIntactCutPasses) {
    mesh::CutMesh cut(mesh::box({.cells = {2, 2, 2}}));
    cut.cut(mesh::CutSurface::plane({0.3, 0, 0}, {1, 0.1, 0.2}));
    Verdict verdict;
    judge_cut(cut, verdict);
    EXPECT_TRUE(verdict.survived) << verdict.reason;
}

TEST(StabilityJudges, TheFirstReasonIsKept) {
    Verdict verdict;
    verdict.fail("this");
    verdict.fail("that");
    EXPECT_FALSE(verdict.survived);
    EXPECT_EQ(verdict.reason, "this");
    verdict.body = "a body";
    verdict.error = 0.25;
    const Verdict again = verdict_of(verdict_json(verdict));
    EXPECT_EQ(again.reason, "this");
    EXPECT_EQ(again.body, "a body");
    EXPECT_EQ(again.error, 0.25);
    EXPECT_FALSE(again.iterations.has_value());
}

}  // namespace
}  // namespace lancet::experiments::stability
