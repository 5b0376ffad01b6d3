// Explicit steps against their equations, with holds, damping and states beyond the scalar.
#include <array>
#include <cmath>

#include "tests/runtime/solve/bodies_under_test.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::test {
namespace {

using runtime::ElementModel;
using runtime::Integrator;

constexpr std::array<int, 3> cells{5, 2, 2};
constexpr double time_step = 5e-4;

runtime::Settings explicit_settings(Integrator integrator) {
    runtime::Settings settings = accurate_settings();
    settings.integrator = integrator;
    settings.energy_safeguard = false;
    settings.time_step = time_step;
    return settings;
}

struct Problem {
    ReferenceSolid solid = jittered_bar(cells, 0.1, 0.15, 201);
    runtime::Scene scene;
    Eigen::VectorXd position, velocity, load;
    Eigen::VectorXd mass;
    std::vector<std::uint8_t> is_free;

    Problem() {
        fix_first_section(solid, cells);
        scene = scene_of(solid);
        scene.gravity = {1, -9.81, 2};
        scene.rayleigh_mass = 20;
        is_free = solid.free_unknowns();
        position = solid.rest() + on_free(random_vector(solid.unknowns(), 0.01, 202));
        velocity = on_free(random_vector(solid.unknowns(), 0.5, 203));
        load = on_free(random_vector(solid.unknowns(), 2, 204));
        mass = solid.mass(false).diagonal();
    }
    Eigen::VectorXd on_free(const Eigen::VectorXd& v) const { return extended(restricted(v, is_free), is_free); }
    std::unique_ptr<runtime::DeformableBody> body(const runtime::Settings& settings) const {
        const auto scheduler = serial();
        auto body = make_body(scene, settings, *scheduler);
        body->set_positions(as_points(position));
        body->set_velocities(as_points(velocity));
        body->set_loads(as_points(load));
        return body;
    }
    /// M^-1 of all forces but the damping.
    Eigen::VectorXd acceleration(const Eigen::VectorXd& x, ElementModel model) const {
        Eigen::VectorXd a = (solid.elastic_force(x, model) + load).cwiseQuotient(mass);
        for (Eigen::Index i = 0; i < a.size(); i += 3) a.segment<3>(i) += Eigen::Vector3d(scene.gravity.data());
        return on_free(a);
    }
};

class ExplicitStepOf : public ::testing::TestWithParam<std::tuple<ElementModel, runtime::ScalarMode>> {};
INSTANTIATE_TEST_SUITE_P(Bodies, ExplicitStepOf,
                         ::testing::Combine(::testing::ValuesIn(all_models), ::testing::ValuesIn(all_scalars)),
                         [](const auto& instance) {
                             return identifier(to_string(std::get<0>(instance.param))) + "_" +
                                    std::string(to_string(std::get<1>(instance.param)));
                         });

TEST_P(ExplicitStepOf, SymplecticEulerSatisfiesItsEquations) {
    const auto& [model, scalar] = GetParam();
    const Problem problem;
    const auto scheduler = serial();
    runtime::Settings settings = explicit_settings(Integrator::symplectic_euler);
    set_model(settings, model);
    settings.scalar = scalar;
    const auto body = problem.body(settings);
    Eigen::VectorXd x = problem.position, v = problem.velocity;
    for (int step = 0; step < 5; ++step) {
        const Eigen::VectorXd a = problem.acceleration(x, model);
        v = (v + time_step * a) / (1 + time_step * problem.scene.rayleigh_mass);
        x += time_step * v;
        const runtime::StepReport report = body->step(*scheduler);
        EXPECT_EQ(report.conjugate_gradient_iterations, 0);
        // Elastic forces cancel to a hundredth of their terms.
        EXPECT_LE((velocities_of(*body) - v).norm(), 200 * epsilon_of(scalar) * v.norm());
        EXPECT_LE((positions_of(*body) - x).norm(), 200 * epsilon_of(scalar) * x.norm());
    }
}

TEST_P(ExplicitStepOf, CentralDifferencesSatisfyTheirEquations) {
    const auto& [model, scalar] = GetParam();
    const Problem problem;
    const auto scheduler = serial();
    runtime::Settings settings = explicit_settings(Integrator::central_differences);
    set_model(settings, model);
    settings.scalar = scalar;
    const auto body = problem.body(settings);
    const double alpha = problem.scene.rayleigh_mass, h = time_step;
    // (v_n+1/2 - v_n-1/2) / h = M^-1 f(x_n) - alpha (v_n+1/2 + v_n-1/2) / 2.
    Eigen::VectorXd x = problem.position;
    Eigen::VectorXd half = problem.velocity + h / 2 * (problem.acceleration(x, model) - alpha * problem.velocity);
    for (int step = 0; step < 5; ++step) {
        x += h * half;
        const Eigen::VectorXd next =
            ((1 - h * alpha / 2) * half + h * problem.acceleration(x, model)) / (1 + h * alpha / 2);
        body->step(*scheduler);
        const Eigen::VectorXd v = (half + next) / 2;
        EXPECT_LE((velocities_of(*body) - v).norm(), 200 * epsilon_of(scalar) * v.norm());
        EXPECT_LE((positions_of(*body) - x).norm(), 200 * epsilon_of(scalar) * x.norm());
        half = next;
    }
}

class Explicit : public ::testing::TestWithParam<Integrator> {};
INSTANTIATE_TEST_SUITE_P(Integrators, Explicit,
                         ::testing::Values(Integrator::symplectic_euler, Integrator::central_differences),
                         [](const auto& instance) { return identifier(to_string(instance.param)); });

TEST_P(Explicit, HeldNodesReachTheirTargetsAndAreLetGo) {
    const Problem problem;
    const auto scheduler = serial();
    const auto body = problem.body(explicit_settings(GetParam()));
    const Eigen::Vector3d direction = Eigen::Vector3d(1, 2, -2) / 3;
    for (int step = 0; step < 20; ++step) {
        const Eigen::Vector3d target = problem.position.segment<3>(3 * 17) + 0.001 * step * Eigen::Vector3d(1, -1, 2);
        const Eigen::Vector3d along = problem.position.segment<3>(3 * 23) + 0.001 * step * direction;
        body->hold(17, {target[0], target[1], target[2]});
        body->hold(23, {along[0], along[1], along[2]}, {direction[0], direction[1], direction[2]});
        body->step(*scheduler);
        const Eigen::VectorXd x = positions_of(*body);
        EXPECT_LE((x.segment<3>(3 * 17) - target).norm(), 1e-15);
        EXPECT_NEAR(direction.dot(x.segment<3>(3 * 23) - along), 0, 1e-15);
    }
    const Eigen::VectorXd held = positions_of(*body);
    body->release_all();
    for (int step = 0; step < 5; ++step) body->step(*scheduler);
    EXPECT_GT((positions_of(*body) - held).segment<3>(3 * 17).norm(), 1e-6);
}

TEST_P(Explicit, HoldsAndFixedNodesAreTheSameConstraint) {
    Problem problem;
    const auto scheduler = serial();
    const auto fixed = problem.body(explicit_settings(GetParam()));
    problem.scene.fixed_nodes.clear();
    const auto held = problem.body(explicit_settings(GetParam()));
    for (const std::int32_t node : problem.solid.fixed) held->hold(node, problem.solid.nodes[node]);
    for (int step = 0; step < 50; ++step) {
        fixed->step(*scheduler);
        held->step(*scheduler);
    }
    // Fixed nodes change the numbering inside, and with it the order of sums.
    EXPECT_LE((positions_of(*fixed) - positions_of(*held)).norm(), 1e-12);
    EXPECT_LE((velocities_of(*fixed) - velocities_of(*held)).norm(), 1e-10);
}

TEST_P(Explicit, GoesOnFromASavedStateToTheBitOnEveryScheduler) {
    const Problem problem;
    const auto first = serial();
    const auto a = problem.body(explicit_settings(GetParam()));
    for (int step = 0; step < 5; ++step) a->step(*first);
    a->hold(17, problem.solid.nodes[17], {0, 0, 1});
    const runtime::BodyState state = a->save();
    for (int step = 0; step < 10; ++step) a->step(*first);
    for (const auto& scheduler : all_schedulers()) {
        const auto b = problem.body(explicit_settings(GetParam()));
        b->restore(*scheduler, state);
        for (int step = 0; step < 10; ++step) b->step(*scheduler);
        EXPECT_EQ(positions_of(*a), positions_of(*b));
        EXPECT_EQ(velocities_of(*a), velocities_of(*b));
    }
}

TEST_P(Explicit, KeepsNoMatrix) {
    const Problem problem;
    const auto scheduler = serial();
    runtime::Settings settings = explicit_settings(GetParam());
    const auto body = problem.body(settings);
    EXPECT_EQ(body->coarse_unknowns(), 0);
    EXPECT_EQ(body->solve_work().flops, 0);
    settings.integrator = Integrator::implicit_midpoint;
    EXPECT_LT(body->bytes(), problem.body(settings)->bytes() * 3 / 4);
    // The matrix of a step is the damped mass.
    const double share = GetParam() == Integrator::symplectic_euler ? 1 : 0.5;
    const Eigen::VectorXd z = problem.on_free(random_vector(problem.solid.unknowns(), 1, 205));
    const Eigen::VectorXd expected =
        (1 + share * time_step * problem.scene.rayleigh_mass) * problem.mass.cwiseProduct(z);
    EXPECT_LE((matrix_times(*body, *scheduler, z) - expected).norm(), 1e-14 * expected.norm());
}

TEST_P(Explicit, StatesThatAreNotFiniteAreReportedAndStopped) {
    const Problem problem;
    const auto scheduler = serial();
    runtime::Settings settings = explicit_settings(GetParam());
    settings.force_time_step = true;
    settings.time_step = 1;
    const auto body = problem.body(settings);
    bool lost = false;
    for (int step = 0; step < 1000 && !lost; ++step) {
        lost = body->step(*scheduler).lost;
        ASSERT_TRUE(positions_of(*body).allFinite());
        ASSERT_TRUE(velocities_of(*body).allFinite());
    }
    EXPECT_TRUE(lost);
    EXPECT_EQ(body->totals().lost, 1);
}

TEST_P(Explicit, DampingProportionalToTheStiffnessIsRefused) {
    Problem problem;
    problem.scene.rayleigh_stiffness = 1e-4;
    try {
        problem.body(explicit_settings(GetParam()));
        ADD_FAILURE() << "no error";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), ::testing::HasSubstr("rayleigh_stiffness"));
    }
}

}  // namespace
}  // namespace lancet::test
