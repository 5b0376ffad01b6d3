// The observed orders in time of every integrator.
#include <array>
#include <cmath>
#include <map>

#include "tests/runtime/solve/bodies_under_test.hpp"
#include <gtest/gtest.h>

namespace lancet::test {
namespace {

using runtime::ElementModel;
using runtime::Integrator;

constexpr std::array<int, 3> cells{3, 1, 1};
constexpr double duration = 0.048;

struct Motion {
    Eigen::VectorXd position, velocity;
};

/// A cantilever that gravity sets in motion from rest, so that no high mode is excited at the start.
Motion moved_by(runtime::Settings settings, int steps) {
    ReferenceSolid solid = jittered_bar(cells, 0.1, 0.1, 171);
    fix_first_section(solid, cells);
    runtime::Scene scene = scene_of(solid);
    scene.gravity = {0, -60, 20};  // the tip moves by half the thickness
    scene.rayleigh_mass = 2;
    settings.time_step = duration / steps;
    const auto scheduler = serial();
    const auto body = make_body(scene, settings, *scheduler);
    for (int step = 0; step < steps; ++step) body->step(*scheduler);
    return {positions_of(*body), velocities_of(*body)};
}

runtime::Settings settings_of(Integrator integrator, ElementModel model) {
    runtime::Settings settings = accurate_settings(1e-13);
    settings.integrator = integrator;
    set_model(settings, model);
    settings.energy_safeguard = false;
    settings.newton_tolerance = 1e-11;
    return settings;
}

/// A step of a 160th of the shortest one below: its error is 1 / 160^2 of theirs at order two.
const Motion& reference(ElementModel model) {
    static std::map<ElementModel, Motion> motions;
    const auto [motion, is_new] = motions.try_emplace(model);
    if (is_new) motion->second = moved_by(settings_of(Integrator::central_differences, model), 160 * 160);
    return motion->second;
}

struct Choice {
    Integrator integrator;
    ElementModel model;
    int newton_iterations;
    double expected;
    double gamma = 0.5;
    double beta = 0.25;
};

std::vector<Choice> choices() {
    std::vector<Choice> all;
    for (const ElementModel model : all_models) {
        for (const int iterations : {1, 50}) {
            all.push_back({Integrator::implicit_euler, model, iterations, 1});
            all.push_back({Integrator::implicit_midpoint, model, iterations, 2});
            // The corotational model has no average stress.
            if (model != ElementModel::corotational) all.push_back({Integrator::energy_momentum, model, iterations, 2});
            all.push_back({Integrator::newmark, model, iterations, 2});
            all.push_back({Integrator::newmark, model, iterations, 2, 0.5, 1.0 / 6});
            all.push_back({Integrator::newmark, model, iterations, 1, 0.7, 0.4});
        }
        all.push_back({Integrator::symplectic_euler, model, 1, 1});
        all.push_back({Integrator::central_differences, model, 1, 2});
    }
    return all;
}

class OrderInTime : public ::testing::TestWithParam<Choice> {};
INSTANTIATE_TEST_SUITE_P(Integrators, OrderInTime, ::testing::ValuesIn(choices()), [](const auto& instance) {
    const Choice& c = instance.param;
    std::string name = identifier(to_string(c.integrator));
    if (c.gamma != 0.5) name += "_damped";
    if (c.beta != 0.25 && c.gamma == 0.5) name += "_linear_acceleration";
    return name + "_" + identifier(to_string(c.model)) + (c.newton_iterations > 1 ? "_iterated" : "_once");
});

TEST_P(OrderInTime, IsThatOfTheTheory) {
    const Choice& choice = GetParam();
    runtime::Settings settings = settings_of(choice.integrator, choice.model);
    settings.newton_iterations = choice.newton_iterations;
    settings.newmark_gamma = choice.gamma;
    settings.newmark_beta = choice.beta;
    const Motion& exact = reference(choice.model);
    std::array<double, 2> position{}, velocity{};
    for (std::size_t k = 0; k < 2; ++k) {
        const Motion motion = moved_by(settings, k == 0 ? 80 : 160);
        position[k] = (motion.position - exact.position).norm();
        velocity[k] = (motion.velocity - exact.velocity).norm();
    }
    const double of_position = std::log2(position[0] / position[1]), of_velocity = std::log2(velocity[0] / velocity[1]);
    RecordProperty("order_position", std::to_string(of_position));
    RecordProperty("order_velocity", std::to_string(of_velocity));
    EXPECT_NEAR(of_position, choice.expected, 0.15);
    EXPECT_NEAR(of_velocity, choice.expected, 0.15);
}

TEST(OrderInTime, OfNonlinearProblemsIsNotThatOfTheLinearOne) {
    // They are nonlinear indeed: the solutions differ by more than the coarsest error above.
    const Eigen::VectorXd& linear = reference(ElementModel::linear).position;
    const Eigen::VectorXd rest = jittered_bar(cells, 0.1, 0.1, 171).rest();
    for (const ElementModel model : {ElementModel::corotational, ElementModel::st_venant_kirchhoff}) {
        EXPECT_GT((linear - reference(model).position).norm(), 0.02 * (linear - rest).norm()) << to_string(model);
    }
}

}  // namespace
}  // namespace lancet::test
