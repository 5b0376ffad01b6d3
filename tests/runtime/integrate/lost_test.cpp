// Motions beyond the scalar: implicit steps report that they are lost, and stop the body where it was.
#include <array>
#include <cmath>

#include "tests/runtime/solve/bodies_under_test.hpp"
#include <gtest/gtest.h>

namespace lancet::test {
namespace {

using runtime::Integrator;

constexpr std::array<int, 3> cells{4, 2, 2};

class Lost : public ::testing::TestWithParam<std::tuple<Integrator, runtime::ScalarMode>> {};
INSTANTIATE_TEST_SUITE_P(Integrators, Lost,
                         ::testing::Combine(::testing::Values(Integrator::implicit_euler, Integrator::implicit_midpoint,
                                                              Integrator::energy_momentum, Integrator::newmark),
                                            ::testing::ValuesIn(all_scalars)),
                         [](const auto& instance) {
                             return identifier(to_string(std::get<0>(instance.param))) + "_" +
                                    std::string(to_string(std::get<1>(instance.param)));
                         });

TEST_P(Lost, StatesAreReportedAndTheBodyGoesOnFromWhereItWas) {
    const auto& [integrator, scalar] = GetParam();
    const ReferenceSolid solid = jittered_bar(cells, 0.1, 0.1, 221);
    runtime::Scene scene = scene_of(solid);
    scene.gravity = {0, -9.81, 0};
    const auto scheduler = serial();
    for (const int iterations : {1, 5}) {
        SCOPED_TRACE(iterations);
        runtime::Settings settings = accurate_settings();
        settings.integrator = integrator;
        // The one nonlinear model that all of them have.
        set_model(settings, runtime::ElementModel::st_venant_kirchhoff);
        settings.scalar = scalar;
        settings.energy_safeguard = false;
        settings.newton_iterations = iterations;
        settings.time_step = 0.01;
        const auto body = make_body(scene, settings, *scheduler);
        for (int step = 0; step < 3; ++step) ASSERT_FALSE(body->step(*scheduler).lost);
        const Eigen::VectorXd before = positions_of(*body);
        // Squares of strains are beyond double.
        body->set_velocities(as_points(random_vector(solid.unknowns(), 1e200, 222)));
        EXPECT_TRUE(body->step(*scheduler).lost);
        EXPECT_EQ(body->totals().lost, 1);
        EXPECT_EQ(positions_of(*body), before);
        EXPECT_EQ(velocities_of(*body), Eigen::VectorXd::Zero(solid.unknowns()));
        for (int step = 0; step < 10; ++step) EXPECT_FALSE(body->step(*scheduler).lost);
        EXPECT_TRUE(positions_of(*body).allFinite());
        EXPECT_TRUE(velocities_of(*body).allFinite());
        // From rest it has fallen for a tenth of a second; implicit Euler falls by g t h / 2 further, 0.0049 m.
        const double fall = (positions_of(*body) - before)(Eigen::seqN(1, solid.unknowns() / 3, 3)).mean();
        EXPECT_NEAR(fall, -0.5 * 9.81 * 0.01, 0.006);
    }
}

}  // namespace
}  // namespace lancet::test
