// One step against its equations, assembled and solved with Eigen.
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/runtime/solve/bodies_under_test.hpp"
#include <gtest/gtest.h>

namespace lancet::test {
namespace {

using runtime::ElementModel;
using runtime::Integrator;
using runtime::Linearisation;
using runtime::MassKind;

constexpr std::array<int, 3> cells{5, 3, 2};
constexpr double time_step = 0.01;

/// A node that is pulled to a place, in all directions or along one.
struct Hold {
    std::int32_t node;
    Eigen::Vector3d target;
    Eigen::Vector3d direction;  ///< zero: all
};

/// A damped, loaded, held and moving bar with one end fixed.
struct Problem {
    ReferenceSolid solid = jittered_bar(cells, 0.1, 0.15, 71);
    runtime::Scene scene;
    Eigen::VectorXd position, velocity, load;
    std::vector<Hold> holds;

    explicit Problem(bool with_holds) {
        fix_first_section(solid, cells);
        scene = scene_of(solid);
        scene.gravity = {1, -9.81, 2};
        scene.rayleigh_mass = 2;
        scene.rayleigh_stiffness = 0.003;
        const std::vector<std::uint8_t> is_free = solid.free_unknowns();
        const auto on_free = [&](double amplitude, unsigned seed) {
            return extended(restricted(random_vector(solid.unknowns(), amplitude, seed), is_free), is_free);
        };
        position = solid.rest() + on_free(0.01, 72);
        velocity = on_free(0.5, 73);
        load = on_free(2, 74);
        if (!with_holds) return;
        holds.push_back({17, position.segment<3>(3 * 17) + Eigen::Vector3d(0.004, 0.002, -0.003), {0, 0, 0}});
        holds.push_back(
            {23, position.segment<3>(3 * 23) + Eigen::Vector3d(-0.002, 0.004, 0.001), Eigen::Vector3d(1, 2, -2) / 3});
    }

    std::unique_ptr<runtime::DeformableBody> body(const runtime::Settings& settings,
                                                  runtime::Scheduler& scheduler) const {
        auto body = make_body(scene, settings, scheduler);
        body->set_positions(as_points(position));
        body->set_velocities(as_points(velocity));
        body->set_loads(as_points(load));
        for (const Hold& hold : holds) {
            const Point target{hold.target[0], hold.target[1], hold.target[2]};
            if (hold.direction.isZero()) {
                body->hold(hold.node, target);
            } else {
                body->hold(hold.node, target, {hold.direction[0], hold.direction[1], hold.direction[2]});
            }
        }
        return body;
    }

    /// Columns: an orthonormal basis of the motions that fixed nodes and holds allow.
    Eigen::MatrixXd allowed() const {
        Eigen::MatrixXd projection = Eigen::MatrixXd::Identity(solid.unknowns(), solid.unknowns());
        for (const std::int32_t node : solid.fixed) projection.block<3, 3>(3 * node, 3 * node).setZero();
        for (const Hold& hold : holds) {
            auto block = projection.block<3, 3>(3 * hold.node, 3 * hold.node);
            if (hold.direction.isZero()) {
                block.setZero();
            } else {
                block -= hold.direction * hold.direction.transpose();
            }
        }
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(projection);
        const Eigen::Index count = (eigen.eigenvalues().array() > 0.5).count();
        return eigen.eigenvectors().rightCols(count);
    }
};

struct Motion {
    Eigen::VectorXd position, velocity;
};

/// The step of the settings, as the documentation of DeformableBody::step and Linearisation states it.
Motion reference_step(const Problem& problem, const runtime::Settings& settings, const Motion& start) {
    const bool corotational = settings.model == ElementModel::corotational;
    const bool is_midpoint = settings.integrator == Integrator::implicit_midpoint;
    const double h = is_midpoint ? settings.time_step / 2 : settings.time_step;
    const double alpha = problem.scene.rayleigh_mass, beta = problem.scene.rayleigh_stiffness;
    const Eigen::MatrixXd mass = problem.solid.mass(settings.mass == MassKind::consistent);
    const Eigen::MatrixXd basis = problem.allowed();
    Eigen::VectorXd weight(problem.solid.unknowns());
    for (Eigen::Index i = 0; i < weight.size(); i += 3) {
        weight.segment<3>(i) = Eigen::Vector3d(problem.scene.gravity.data());
    }
    const Eigen::VectorXd external = mass * weight + problem.load;

    // Held nodes get the velocity that takes them to their targets.
    Eigen::VectorXd velocity = start.velocity;
    for (const Hold& hold : problem.holds) {
        auto v = velocity.segment<3>(3 * hold.node);
        const Eigen::Vector3d wanted = (hold.target - start.position.segment<3>(3 * hold.node)) / settings.time_step;
        if (hold.direction.isZero()) {
            v = wanted;
        } else {
            v += hold.direction * hold.direction.dot(wanted - v);
        }
    }
    const bool at_prediction = settings.linearisation == Linearisation::prediction;
    const Eigen::VectorXd at = at_prediction ? Eigen::VectorXd(start.position + h * velocity) : start.position;
    const Eigen::MatrixXd stiffness = problem.solid.stiffness(at, corotational);
    const Eigen::MatrixXd damping = alpha * mass + beta * stiffness;
    const Eigen::MatrixXd matrix = mass + h * damping + h * h * stiffness;
    Eigen::VectorXd right = h * (problem.solid.elastic_force(at, corotational) + external) - h * (damping * velocity);
    if (!at_prediction) right -= h * h * (stiffness * velocity);
    // What the held nodes' change of velocity takes, of which a half step sees half.
    right -= h / settings.time_step * (mass * (velocity - start.velocity));
    const Eigen::VectorXd change = basis * (basis.transpose() * matrix * basis).llt().solve(basis.transpose() * right);
    Motion end{start.position, velocity + change};
    end.position += settings.time_step * end.velocity;
    if (is_midpoint) end.velocity = 2 * end.velocity - velocity;
    return end;
}

void expect_the_reference(const runtime::Settings& settings, bool with_holds, int steps) {
    const Problem problem(with_holds);
    const auto scheduler = serial();
    const auto body = problem.body(settings, *scheduler);
    Motion motion{problem.position, problem.velocity};
    for (int step = 0; step < steps; ++step) {
        motion = reference_step(problem, settings, motion);
        const runtime::StepReport report = body->step(*scheduler);
        EXPECT_EQ(report.newton_iterations, 1);
        EXPECT_FALSE(report.repeated);
        const double moved = (motion.position - problem.solid.rest()).cwiseAbs().maxCoeff();
        const double fastest = motion.velocity.cwiseAbs().maxCoeff();
        // Systems are solved to 1e-12 in the norm of the preconditioner, with a condition below 1e3.
        EXPECT_LE((positions_of(*body) - motion.position).cwiseAbs().maxCoeff(), 1e-9 * moved) << "step " << step;
        EXPECT_LE((velocities_of(*body) - motion.velocity).cwiseAbs().maxCoeff(), 1e-9 * fastest) << "step " << step;
    }
    EXPECT_NEAR(body->time(), steps * settings.time_step, 1e-15);
}

runtime::Settings one_linearisation() {
    runtime::Settings settings = accurate_settings();
    settings.time_step = time_step;
    settings.energy_safeguard = false;
    return settings;
}

using LinearisedChoice = std::tuple<ElementModel, Linearisation, MassKind, bool>;

std::string choice_name(const ::testing::TestParamInfo<LinearisedChoice>& instance) {
    const auto& [model, linearisation, mass, with_holds] = instance.param;
    return std::string(model == ElementModel::linear ? "linear_" : "corotational_") +
           std::string(to_string(linearisation)) + "_" + std::string(to_string(mass)) +
           (with_holds ? "_held" : "_free");
}

class LinearisedStep : public ::testing::TestWithParam<LinearisedChoice> {};
INSTANTIATE_TEST_SUITE_P(Settings, LinearisedStep,
                         ::testing::Combine(::testing::Values(ElementModel::linear, ElementModel::corotational),
                                            ::testing::Values(Linearisation::state, Linearisation::prediction),
                                            ::testing::ValuesIn(all_masses), ::testing::Bool()),
                         choice_name);

TEST_P(LinearisedStep, EqualsTheAssembledEquations) {
    const auto& [model, linearisation, mass, with_holds] = GetParam();
    runtime::Settings settings = one_linearisation();
    settings.model = model;
    settings.linearisation = linearisation;
    settings.mass = mass;
    expect_the_reference(settings, with_holds, 3);
}

TEST(Step, EqualsTheAssembledEquationsForEveryOperatorAndPreconditioner) {
    for (const auto kind : all_operators) {
        for (const auto preconditioner : all_preconditioners) {
            SCOPED_TRACE(::testing::Message() << to_string(kind) << ", " << to_string(preconditioner));
            runtime::Settings settings = one_linearisation();
            settings.matrix = kind;
            settings.preconditioner = preconditioner;
            expect_the_reference(settings, true, 1);
        }
    }
}

TEST(Step, OfTheMidpointRuleEqualsTheAssembledEquations) {
    runtime::Settings settings = one_linearisation();
    settings.integrator = Integrator::implicit_midpoint;
    expect_the_reference(settings, false, 3);
}

class NewtonStep : public ::testing::TestWithParam<MassKind> {};
INSTANTIATE_TEST_SUITE_P(Masses, NewtonStep, ::testing::ValuesIn(all_masses),
                         [](const auto& instance) { return std::string(to_string(instance.param)); });

TEST_P(NewtonStep, SatisfiesTheEquationsOfImplicitEuler) {
    const Problem problem(true);
    const auto scheduler = serial();
    runtime::Settings settings = one_linearisation();
    settings.newton_iterations = 100;
    settings.newton_tolerance = 1e-10;
    settings.mass = GetParam();
    const auto body = problem.body(settings, *scheduler);
    Motion start{problem.position, problem.velocity};
    for (int step = 0; step < 2; ++step) {
        const runtime::StepReport report = body->step(*scheduler);
        EXPECT_LT(report.newton_iterations, 100);
        EXPECT_GT(report.newton_iterations, 1);
        const Motion end{positions_of(*body), velocities_of(*body)};
        const double h = settings.time_step;
        EXPECT_LE((end.position - start.position - h * end.velocity).cwiseAbs().maxCoeff(), 1e-14);
        const Eigen::MatrixXd mass = problem.solid.mass(GetParam() == MassKind::consistent);
        Eigen::VectorXd weight(problem.solid.unknowns());
        for (Eigen::Index i = 0; i < weight.size(); i += 3) {
            weight.segment<3>(i) = Eigen::Vector3d(problem.scene.gravity.data());
        }
        const Eigen::VectorXd external = mass * weight + problem.load;
        const Eigen::MatrixXd damping = problem.scene.rayleigh_mass * mass +
                                        problem.scene.rayleigh_stiffness * problem.solid.stiffness(end.position, true);
        const Eigen::VectorXd residual =
            mass * (end.velocity - start.velocity) -
            h * (problem.solid.elastic_force(end.position, true) + external - damping * end.velocity);
        const Eigen::MatrixXd basis = problem.allowed();
        const double scale = h * (basis.transpose() * external).norm();
        EXPECT_LE((basis.transpose() * residual).norm(), 1e-8 * scale);
        start = end;
    }
}

TEST(Step, TakesHeldNodesToTheirTargets) {
    const Problem problem(true);
    const auto scheduler = serial();
    for (const bool safeguard : {false, true}) {
        runtime::Settings settings = one_linearisation();
        settings.energy_safeguard = safeguard;
        const auto body = problem.body(settings, *scheduler);
        for (int step = 0; step < 3; ++step) {
            body->step(*scheduler);
            const Eigen::VectorXd x = positions_of(*body);
            const Hold &full = problem.holds[0], &along = problem.holds[1];
            EXPECT_LE((x.segment<3>(3 * full.node) - full.target).norm(), 1e-14);
            EXPECT_NEAR(along.direction.dot(x.segment<3>(3 * along.node) - along.target), 0, 1e-14);
            EXPECT_GT((x.segment<3>(3 * along.node) - along.target).norm(), 1e-6) << "it is free across";
        }
        body->release(problem.holds[0].node);
        body->release_all();
        body->step(*scheduler);
        EXPECT_GT((positions_of(*body).segment<3>(3 * 17) - problem.holds[0].target).norm(), 1e-6);
    }
}

TEST(Step, HoldsAndFixedNodesAreTheSameConstraint) {
    // Eliminated at rest, or held at rest by the filter: the other nodes move alike.
    Problem problem(false);
    const auto scheduler = serial();
    const runtime::Settings settings = one_linearisation();
    const auto fixed = problem.body(settings, *scheduler);
    const std::vector<std::int32_t> held = problem.solid.fixed;
    const std::vector<Point> rest = problem.solid.nodes;
    problem.scene.fixed_nodes.clear();
    const auto filtered = problem.body(settings, *scheduler);
    for (const std::int32_t node : held) filtered->hold(node, rest[node]);
    for (int step = 0; step < 3; ++step) {
        fixed->step(*scheduler);
        filtered->step(*scheduler);
        const Eigen::VectorXd x = positions_of(*fixed);
        EXPECT_LE((positions_of(*filtered) - x).cwiseAbs().maxCoeff(),
                  1e-9 * (x - problem.solid.rest()).cwiseAbs().maxCoeff());
    }
}

class StepArithmetic : public ArithmeticTest {};
INSTANTIATE_TEST_SUITE_P(Arithmetics, StepArithmetic, ::testing::ValuesIn(compiled_arithmetics()), ArithmeticName());

TEST_P(StepArithmetic, AgreesWithDouble) {
    const Problem problem(true);
    const auto scheduler = serial();
    runtime::Settings settings = one_linearisation();
    const Motion expected = reference_step(problem, settings, {problem.position, problem.velocity});
    GetParam().set(settings);
    settings.conjugate_gradients = {.iterations = 100, .tolerance = 1e-6};
    if (GetParam().scalar == runtime::ScalarMode::double_precision) settings.conjugate_gradients.tolerance = 1e-12;
    const auto body = problem.body(settings, *scheduler);
    body->step(*scheduler);
    // The condition of the system, below 1e3, times the rounding of its entries.
    const double tolerance = std::max(1e-9, 1000 * GetParam().epsilon());
    EXPECT_LE((velocities_of(*body) - expected.velocity).cwiseAbs().maxCoeff(),
              tolerance * expected.velocity.cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace lancet::test
