// Trajectories do not depend on the scheduler or the number of threads, to the bit.
#include <array>

#include "tests/runtime/solve/bodies_under_test.hpp"
#include <gtest/gtest.h>

namespace lancet::test {
namespace {

void expect_equal_trajectories(const runtime::Settings& settings) {
    ReferenceSolid solid = jittered_bar({8, 3, 2}, 0.1, 0.15, 111);
    fix_first_section(solid, {8, 3, 2});
    runtime::Scene scene = scene_of(solid);
    scene.gravity = {0, -9.81, 0};
    scene.rayleigh_stiffness = 0.001;
    Eigen::VectorXd position, velocity;
    for (const auto& scheduler : all_schedulers()) {
        const auto body = make_body(scene, settings, *scheduler);
        ASSERT_GT(body->blocks(), 3);
        body->hold(8, {0.75, 0.1, 0.05});
        for (int step = 0; step < 20; ++step) {
            if (step == 10) body->release(8);
            body->step(*scheduler);
        }
        if (position.size() == 0) {
            position = positions_of(*body);
            velocity = velocities_of(*body);
            ASSERT_TRUE(position.allFinite());
            ASSERT_GT((position - solid.rest()).cwiseAbs().maxCoeff(), 0.01);
        }
        EXPECT_EQ(positions_of(*body), position) << to_string(scheduler->kind()) << " " << scheduler->threads();
        EXPECT_EQ(velocities_of(*body), velocity) << to_string(scheduler->kind()) << " " << scheduler->threads();
    }
}

runtime::Settings default_settings() {
    runtime::Settings settings;
    settings.numbering = {.nodes_per_block = 24, .nodes_per_aggregate = 12};
    return settings;
}

class SchedulerAgreement : public ArithmeticTest {};
INSTANTIATE_TEST_SUITE_P(Arithmetics, SchedulerAgreement, ::testing::ValuesIn(compiled_arithmetics()),
                         ArithmeticName());

TEST_P(SchedulerAgreement, OfTheDefaultSettings) {
    runtime::Settings settings = default_settings();
    GetParam().set(settings);
    expect_equal_trajectories(settings);
}

TEST(SchedulersAgree, OnEveryOperatorScatterStrategyAndPreconditioner) {
    for (const auto kind : all_operators) {
        for (const auto scatter : all_scatters) {
            for (const auto preconditioner : all_preconditioners) {
                SCOPED_TRACE(::testing::Message()
                             << to_string(kind) << ", " << to_string(scatter) << ", " << to_string(preconditioner));
                runtime::Settings settings = default_settings();
                settings.matrix = kind;
                settings.scatter = scatter;
                settings.preconditioner = preconditioner;
                expect_equal_trajectories(settings);
            }
        }
    }
}

}  // namespace
}  // namespace lancet::test
