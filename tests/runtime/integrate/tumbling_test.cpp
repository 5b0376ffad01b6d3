// An undamped body that tumbles for 10,000 steps: what each integrator keeps, and to what.
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string>
#include <tuple>

#include "tests/runtime/solve/bodies_under_test.hpp"
#include <gtest/gtest.h>

namespace lancet::test {
namespace {

using runtime::ElementModel;
using runtime::Integrator;

constexpr std::array<int, 3> cells{3, 1, 1};
constexpr int steps = 10000;

struct Course {
    double start = 0;                                  ///< energy, joules
    double largest_deviation = 0;                      ///< of the energy, relative
    double first_half_mean = 0, second_half_mean = 0;  ///< relative deviations
    double momentum = 0, angular_momentum = 0;         ///< largest relative deviations
};

std::string number(double value) {
    std::ostringstream text;
    text << value;
    return text.str();
}

Course tumble(runtime::Settings settings, double spin, int count) {
    const ReferenceSolid solid = jittered_bar(cells, 0.1, 0.1, 231);
    const auto scheduler = serial();
    const auto body = make_body(scene_of(solid), settings, *scheduler);
    Eigen::VectorXd mass(solid.unknowns());
    for (std::size_t node = 0; node < body->nodes(); ++node) {
        mass.segment<3>(3 * static_cast<Eigen::Index>(node))
            .setConstant(body->nodal_mass(static_cast<std::int32_t>(node)));
    }
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (Eigen::Index i = 0; i < mass.size(); i += 3) {
        centre += mass[i] / (mass.sum() / 3) * solid.rest().segment<3>(i);
    }
    Eigen::VectorXd velocity(solid.unknowns());
    const Eigen::Vector3d axis = spin * Eigen::Vector3d(0.3, 0.5, 1).normalized();
    for (Eigen::Index i = 0; i < velocity.size(); i += 3) {
        velocity.segment<3>(i) =
            axis.cross(Eigen::Vector3d(solid.rest().segment<3>(i) - centre)) + Eigen::Vector3d(0.02, 0.01, -0.01);
    }
    body->set_velocities(as_points(velocity));

    const Eigen::VectorXd momenta = mass.cwiseProduct(velocity);
    const Eigen::Vector3d linear = total_force(momenta), angular = total_torque(solid.rest(), momenta);
    Course course;
    course.start = body->energies(*scheduler).total();
    for (int step = 0; step < count; ++step) {
        body->step(*scheduler);
        const double deviation = body->energies(*scheduler).total() / course.start - 1;
        course.largest_deviation = std::max(course.largest_deviation, std::abs(deviation));
        (step < count / 2 ? course.first_half_mean : course.second_half_mean) += deviation / (count / 2.0);
        if (step % 10 != 9) continue;
        const Eigen::VectorXd now = mass.cwiseProduct(velocities_of(*body));
        course.momentum = std::max(course.momentum, (total_force(now) - linear).norm() / now.cwiseAbs().sum());
        course.angular_momentum = std::max(course.angular_momentum,
                                           (total_torque(positions_of(*body), now) - angular).norm() / angular.norm());
    }
    // XML reports keep what was observed.
    ::testing::Test::RecordProperty("energy", number(course.largest_deviation));
    ::testing::Test::RecordProperty("energy_drift", number(course.second_half_mean - course.first_half_mean));
    ::testing::Test::RecordProperty("momentum", number(course.momentum));
    ::testing::Test::RecordProperty("angular_momentum", number(course.angular_momentum));
    return course;
}

runtime::Settings settings_of(Integrator integrator, ElementModel model, double time_step) {
    runtime::Settings settings = accurate_settings(1e-13);
    settings.integrator = integrator;
    set_model(settings, model);
    settings.time_step = time_step;
    settings.energy_safeguard = false;
    if (!runtime::is_explicit(integrator)) {
        settings.newton_iterations = 50;
        settings.newton_tolerance = 1e-11;
    }
    return settings;
}

// The linear model has no rotations: a body that tumbles blows up in it, without losing energy; so the spin is slow.
TEST(Tumbling, TheMidpointRuleKeepsTheEnergyOfTheLinearModelAndItsMomentum) {
    const Course course = tumble(settings_of(Integrator::implicit_midpoint, ElementModel::linear, 0.004), 0.5, steps);
    // Each step is off by its tolerance at most, and steps are as likely off in one direction as in the other.
    EXPECT_LE(course.largest_deviation, 1e-9);
    EXPECT_LE(course.momentum, 1e-9);
}

TEST(Tumbling, TheMidpointRuleKeepsMomentaAndBoundsTheEnergy) {
    const double spin = 6;
    const Course coarse =
        tumble(settings_of(Integrator::implicit_midpoint, ElementModel::corotational, 0.004), spin, steps);
    const Course fine =
        tumble(settings_of(Integrator::implicit_midpoint, ElementModel::corotational, 0.002), spin, steps);
    for (const Course* course : {&coarse, &fine}) {
        EXPECT_LE(course->momentum, 1e-9);
        EXPECT_LE(course->angular_momentum, 1e-8);
        EXPECT_LE(std::abs(course->second_half_mean - course->first_half_mean), 0.25 * course->largest_deviation)
            << "no drift";
    }
    EXPECT_LE(coarse.largest_deviation, 1e-2);
    EXPECT_NEAR(std::log2(coarse.largest_deviation / fine.largest_deviation), 2, 0.4) << "of order dt^2";
}

TEST(Tumbling, NewmarkWithAverageAccelerationBoundsTheEnergy) {
    const Course course = tumble(settings_of(Integrator::newmark, ElementModel::corotational, 0.004), 6, steps);
    EXPECT_LE(course.momentum, 1e-9);
    EXPECT_LE(course.largest_deviation, 1e-2);
}

class Symplectic : public ::testing::TestWithParam<std::tuple<Integrator, ElementModel>> {};
INSTANTIATE_TEST_SUITE_P(
    Integrators, Symplectic,
    ::testing::Combine(::testing::Values(Integrator::symplectic_euler, Integrator::central_differences),
                       ::testing::Values(ElementModel::corotational, ElementModel::st_venant_kirchhoff)),
    [](const auto& instance) {
        return identifier(to_string(std::get<0>(instance.param))) + "_" +
               identifier(to_string(std::get<1>(instance.param)));
    });

TEST_P(Symplectic, KeepsMomentaToRoundingAndBoundsTheEnergy) {
    const auto& [integrator, model] = GetParam();
    for (const double time_step : {1e-3, 5e-4}) {
        const Course course = tumble(settings_of(integrator, model, time_step), 6, steps);
        EXPECT_LE(course.momentum, 1e-12);
        EXPECT_LE(course.angular_momentum, 1e-10);
        EXPECT_LE(course.largest_deviation, 2e-2);
        EXPECT_LE(std::abs(course.second_half_mean - course.first_half_mean), 0.25 * course.largest_deviation)
            << "no drift";
    }
}

}  // namespace
}  // namespace lancet::test
