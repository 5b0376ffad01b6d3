// Static equilibria, reached by stepping, against solutions that were not computed with this library.
#include <array>
#include <cmath>

#include "tests/runtime/solve/bodies_under_test.hpp"
#include "tests/verification/reference_table.hpp"
#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "lancet/mesh/generate/box.hpp"

namespace lancet::test {
namespace {

using runtime::ElementModel;

/// Solves f(x) + M g = 0 with the stiffness of the rotated elements as the derivative.
Eigen::VectorXd reference_equilibrium(const ReferenceSolid& solid, const Eigen::Vector3d& gravity) {
    const std::vector<std::uint8_t> is_free = solid.free_unknowns();
    Eigen::VectorXd weight(solid.unknowns());
    for (Eigen::Index i = 0; i < weight.size(); i += 3) weight.segment<3>(i) = gravity;
    weight = (solid.mass(false) * weight).eval();
    Eigen::VectorXd x = solid.rest();
    for (int iteration = 0; iteration < 500; ++iteration) {
        const Eigen::VectorXd residual = restricted(Eigen::VectorXd(solid.elastic_force(x, true) + weight), is_free);
        if (residual.norm() < 1e-11 * weight.norm()) return x;
        const Eigen::VectorXd change = restricted(solid.stiffness(x, true), is_free).llt().solve(residual);
        x += extended(change, is_free);
    }
    ADD_FAILURE() << "the reference did not converge";
    return x;
}

TEST(Equilibrium, OfASmallBarIsThatOfNewtonsMethod) {
    const std::array<int, 3> cells{5, 1, 1};
    ReferenceSolid solid = jittered_bar(cells, 0.1, 0.1, 131);
    fix_first_section(solid, cells);
    const Eigen::VectorXd expected = reference_equilibrium(solid, {0, -9.81, 0});
    const double deflection = (expected - solid.rest()).cwiseAbs().maxCoeff();
    ASSERT_GT(deflection, 0.005);
    const auto scheduler = serial();
    runtime::Scene scene = scene_of(solid);
    scene.gravity = {0, -9.81, 0};
    scene.rayleigh_mass = 2;
    scene.rayleigh_stiffness = 0.01;
    for (const auto linearisation : {runtime::Linearisation::prediction, runtime::Linearisation::state}) {
        for (const bool safeguard : {false, true}) {
            runtime::Settings settings = accurate_settings();
            settings.linearisation = linearisation;
            settings.energy_safeguard = safeguard;
            const auto body = make_body(scene, settings, *scheduler);
            for (int step = 0; step < 400; ++step) body->step(*scheduler);
            EXPECT_LE((positions_of(*body) - expected).cwiseAbs().maxCoeff(), 1e-9 * deflection);
            EXPECT_LE(velocities_of(*body).cwiseAbs().maxCoeff(), 1e-8);
        }
    }
    // The default arithmetic comes to rest at the same place, to the rounding of float times the condition of K.
    const auto body = make_body(scene, {}, *scheduler);
    for (int step = 0; step < 400; ++step) body->step(*scheduler);
    EXPECT_LE((positions_of(*body) - expected).cwiseAbs().maxCoeff(), 1e-4 * deflection);
}

class DiscreteReference : public ::testing::TestWithParam<ElementModel> {};
INSTANTIATE_TEST_SUITE_P(Models, DiscreteReference, ::testing::Values(ElementModel::linear, ElementModel::corotational),
                         [](const auto& instance) {
                             return instance.param == ElementModel::linear ? "linear" : "corotational";
                         });

TEST_P(DiscreteReference, UncutBeamHasTheSameNodalDisplacements) {
    const bool is_linear = GetParam() == ElementModel::linear;
    const auto folder = reference_folder() / "discrete";
    const auto expected = read_numbers(folder / (is_linear ? "D2_uncut_linear.csv" : "D2_uncut_corot.csv"));
    if (expected.empty()) GTEST_SKIP() << "no reference displacements in " << folder;
    runtime::Scene scene;
    // The beam along z, clamped at z = 0, gravity along x.
    scene.mesh = mesh::box({.cells = {4, 8, 26}, .size = {0.03, 0.06, 0.2}, .swap_parity = true});
    const auto clamped = scene.mesh.node_set("z_min");
    scene.fixed_nodes.assign(clamped.begin(), clamped.end());
    scene.materials = {{0, {.young_modulus = 3e5, .poisson_ratio = 0.35, .density = 1070}}};
    scene.gravity = {9.81, 0, 0};
    ASSERT_EQ(expected.size(), scene.mesh.nodes().size());

    // A step so long that inertia is nothing: dt^2 K outweighs M by 1e12 and more.
    runtime::Settings settings;
    settings.scalar = runtime::ScalarMode::double_precision;
    settings.model = GetParam();
    settings.time_step = 1e6;
    settings.energy_safeguard = false;
    settings.newton_iterations = 200;
    settings.newton_tolerance = 1e-10;
    settings.conjugate_gradients = {.iterations = 5000, .tolerance = 1e-13};
    const auto scheduler = serial();
    const auto body = make_body(scene, settings, *scheduler);
    const runtime::StepReport report = body->step(*scheduler);
    EXPECT_LT(report.newton_iterations, 200) << "Newton's iterations did not reach their tolerance";

    Eigen::VectorXd displacement(3 * static_cast<Eigen::Index>(expected.size()));
    for (const std::vector<double>& row : expected) {
        ASSERT_EQ(row.size(), 4U);
        displacement.segment<3>(3 * static_cast<Eigen::Index>(row[0])) = Eigen::Vector3d(row[1], row[2], row[3]);
    }
    const double largest = displacement.cwiseAbs().maxCoeff();
    ASSERT_GT(largest, 0.05);
    const Eigen::VectorXd moved = positions_of(*body) - as_vector(scene.mesh.nodes());
    EXPECT_LE((moved - displacement).cwiseAbs().maxCoeff(), 1e-9 * largest);
    // Energies in joules to the digits that the reference gives.
    const double energy = body->energies(*scheduler).elastic;
    EXPECT_NEAR(energy, is_linear ? 0.0620093811079 : 0.0536467723732, 1e-11);
}

}  // namespace
}  // namespace lancet::test
