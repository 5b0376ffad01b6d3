// The product with the step matrix against the matrix assembled with Eigen, for every way of computing it.
#include <array>
#include <cmath>

#include "tests/runtime/solve/bodies_under_test.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::test {
namespace {

using runtime::ElementModel;
using runtime::MassKind;
using runtime::OperatorKind;

constexpr std::array<int, 3> cells{5, 3, 2};
constexpr double time_step = 0.01;

ReferenceSolid solid_under_test() {
    ReferenceSolid solid = jittered_bar(cells, 0.1, 0.15, 11);
    fix_first_section(solid, cells);
    return solid;
}

runtime::Scene damped_scene(const ReferenceSolid& solid) {
    runtime::Scene scene = scene_of(solid);
    scene.rayleigh_mass = 3;
    scene.rayleigh_stiffness = 0.02;
    return scene;
}

/// Bent and turned: rotations of all sizes, strains of some 20 %, and one element inside out.
Eigen::VectorXd deformed_state(const ReferenceSolid& solid) {
    Eigen::VectorXd x = solid.rest();
    for (Eigen::Index i = 0; i < x.size(); i += 3) {
        const double angle = 4 * x[i], y = x[i + 1];
        x[i + 1] = y * std::cos(angle) - x[i + 2] * std::sin(angle);
        x[i + 2] = y * std::sin(angle) + x[i + 2] * std::cos(angle);
    }
    x += random_vector(x.size(), 0.012, 12);
    const std::vector<std::uint8_t> is_free = solid.free_unknowns();
    for (std::size_t i = 0; i < is_free.size(); ++i) {
        if (is_free[i] == 0) x[static_cast<Eigen::Index>(i)] = solid.rest()[static_cast<Eigen::Index>(i)];
    }
    return x;
}

/// (1 + dt alpha) M + (dt^2 + dt beta) K on the free unknowns, zero elsewhere; and the sum of the absolute values of
/// what was added up, for the size of rounding errors.
Eigen::MatrixXd reference_matrix(const ReferenceSolid& solid, const runtime::Scene& scene, MassKind mass,
                                 ElementModel model) {
    const Eigen::MatrixXd k = solid.stiffness(deformed_state(solid), model == ElementModel::corotational);
    Eigen::MatrixXd a = (1 + time_step * scene.rayleigh_mass) * solid.mass(mass == MassKind::consistent) +
                        (time_step * time_step + time_step * scene.rayleigh_stiffness) * k;
    const std::vector<std::uint8_t> is_free = solid.free_unknowns();
    for (std::size_t i = 0; i < is_free.size(); ++i) {
        if (is_free[i] != 0) continue;
        a.row(static_cast<Eigen::Index>(i)).setZero();
        a.col(static_cast<Eigen::Index>(i)).setZero();
    }
    return a;
}

runtime::Settings settings_of(const Arithmetic& arithmetic, OperatorKind kind, kernels::ScatterStrategy scatter,
                              MassKind mass, ElementModel model = ElementModel::corotational) {
    runtime::Settings settings = accurate_settings();
    arithmetic.set(settings);
    settings.time_step = time_step;
    settings.matrix = kind;
    settings.scatter = scatter;
    settings.mass = mass;
    settings.model = model;
    return settings;
}

class StepMatrix : public ArithmeticTest {};
INSTANTIATE_TEST_SUITE_P(Arithmetics, StepMatrix, ::testing::ValuesIn(compiled_arithmetics()), ArithmeticName());

TEST_P(StepMatrix, EqualsTheAssembledMatrix) {
    const ReferenceSolid solid = solid_under_test();
    const runtime::Scene scene = damped_scene(solid);
    const auto scheduler = serial();
    const Eigen::VectorXd z = random_vector(solid.unknowns(), 1, 13);
    const std::vector<Point> deformed = as_points(deformed_state(solid));
    for (const ElementModel model : {ElementModel::corotational, ElementModel::linear}) {
        for (const MassKind mass : all_masses) {
            const Eigen::MatrixXd a = reference_matrix(solid, scene, mass, model);
            const Eigen::VectorXd expected = a * z;
            // A row adds up some 30 blocks of terms that partly cancel, each from rotated gradients with an error of a
            // few eps: rounding is measured by |A| |z|.
            const Eigen::VectorXd size = a.cwiseAbs() * z.cwiseAbs();
            const double tolerance = 40 * GetParam().epsilon() * size.maxCoeff();
            for (const OperatorKind kind : all_operators) {
                for (const auto scatter : all_scatters) {
                    SCOPED_TRACE(::testing::Message() << to_string(kind) << ", " << to_string(scatter) << ", "
                                                      << to_string(mass) << ", model " << static_cast<int>(model));
                    const auto body = make_body(scene, settings_of(GetParam(), kind, scatter, mass, model), *scheduler);
                    body->set_positions(deformed);
                    const Eigen::VectorXd product = matrix_times(*body, *scheduler, z);
                    EXPECT_LE((product - expected).cwiseAbs().maxCoeff(), tolerance);
                }
            }
        }
    }
}

TEST_P(StepMatrix, IsTheSameToTheBitOnAllSchedulers) {
    const ReferenceSolid solid = solid_under_test();
    const runtime::Scene scene = damped_scene(solid);
    const Eigen::VectorXd z = random_vector(solid.unknowns(), 1, 14);
    const std::vector<Point> deformed = as_points(deformed_state(solid));
    const auto schedulers = all_schedulers();
    ASSERT_GE(schedulers.size(), 4U);
    for (const OperatorKind kind : all_operators) {
        for (const auto scatter : all_scatters) {
            SCOPED_TRACE(::testing::Message() << to_string(kind) << ", " << to_string(scatter));
            Eigen::VectorXd product, force;
            for (const auto& scheduler : schedulers) {
                const auto body =
                    make_body(scene, settings_of(GetParam(), kind, scatter, MassKind::lumped), *scheduler);
                ASSERT_GT(body->blocks(), 2);
                body->set_positions(deformed);
                const Eigen::VectorXd other_product = matrix_times(*body, *scheduler, z);
                const Eigen::VectorXd other_force = elastic_forces_of(*body, *scheduler);
                if (product.size() == 0) {
                    product = other_product;
                    force = other_force;
                }
                EXPECT_EQ(product, other_product) << to_string(scheduler->kind()) << " " << scheduler->threads();
                EXPECT_EQ(force, other_force) << to_string(scheduler->kind()) << " " << scheduler->threads();
            }
        }
    }
}

TEST_P(StepMatrix, IsSymmetricAndPositiveDefinite) {
    ReferenceSolid solid = jittered_bar({2, 2, 1}, 0.1, 0.15, 15);
    fix_first_section(solid, {2, 2, 1});
    const runtime::Scene scene = damped_scene(solid);
    const auto scheduler = serial();
    const std::vector<Point> deformed = as_points(deformed_state(solid));
    for (const OperatorKind kind : all_operators) {
        for (const MassKind mass : all_masses) {
            SCOPED_TRACE(::testing::Message() << to_string(kind) << ", " << to_string(mass));
            const auto body = make_body(
                scene, settings_of(GetParam(), kind, kernels::ScatterStrategy::private_copies, mass), *scheduler);
            body->set_positions(deformed);
            Eigen::MatrixXd a(solid.unknowns(), solid.unknowns());
            for (Eigen::Index i = 0; i < a.cols(); ++i) {
                a.col(i) = matrix_times(*body, *scheduler, Eigen::VectorXd::Unit(a.cols(), i));
            }
            a = restricted(a, solid.free_unknowns());
            const double largest = a.cwiseAbs().maxCoeff();
            EXPECT_LE((a - a.transpose()).cwiseAbs().maxCoeff(), 20 * GetParam().epsilon() * largest);
            const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(0.5 * (a + a.transpose()),
                                                                       Eigen::EigenvaluesOnly);
            // K is semidefinite, so no eigenvalue lies below the smallest of the mass.
            const Eigen::MatrixXd m = restricted(solid.mass(mass == MassKind::consistent), solid.free_unknowns());
            const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> of_mass(m, Eigen::EigenvaluesOnly);
            const double rounding = 20 * GetParam().epsilon() * static_cast<double>(a.rows()) * largest;
            EXPECT_GT(eigen.eigenvalues().minCoeff(), of_mass.eigenvalues().minCoeff() - rounding);
        }
    }
}

TEST_P(StepMatrix, OfABodyWithoutFixedNodesMapsTranslationsToTheMass) {
    const ReferenceSolid solid = jittered_bar({3, 2, 2}, 0.1, 0.15, 16);
    const runtime::Scene scene = scene_of(solid);
    const auto scheduler = serial();
    for (const OperatorKind kind : all_operators) {
        for (const MassKind mass : all_masses) {
            SCOPED_TRACE(::testing::Message() << to_string(kind) << ", " << to_string(mass));
            const auto body = make_body(
                scene, settings_of(GetParam(), kind, kernels::ScatterStrategy::private_copies, mass), *scheduler);
            Eigen::VectorXd z = Eigen::VectorXd::Zero(solid.unknowns());
            for (Eigen::Index i = 0; i < z.size(); i += 3) z[i + 1] = 1;
            const Eigen::VectorXd product = matrix_times(*body, *scheduler, z);
            // Edge blocks and rotated gradients take differences: exact. Block rows add up rounded blocks.
            const Eigen::MatrixXd a =
                solid.mass(mass == MassKind::consistent) + time_step * time_step * solid.stiffness(solid.rest(), false);
            const double tolerance = 40 * GetParam().epsilon() * (a.cwiseAbs() * z).maxCoeff();
            for (std::int32_t node = 0; node < static_cast<std::int32_t>(solid.nodes.size()); ++node) {
                EXPECT_NEAR(
                    product[3 * node + 1], body->nodal_mass(node),
                    kind == OperatorKind::block_rows ? tolerance : 4 * GetParam().epsilon() * body->nodal_mass(node));
                EXPECT_NEAR(product[3 * node], 0, kind == OperatorKind::block_rows ? tolerance : 0.0);
            }
        }
    }
}

TEST(OperatorKind, HasNames) {
    for (const OperatorKind kind : all_operators) {
        EXPECT_EQ(runtime::operator_kind_from_string(to_string(kind)), kind);
    }
    for (const MassKind mass : all_masses) EXPECT_EQ(runtime::mass_kind_from_string(to_string(mass)), mass);
    EXPECT_THROW(runtime::operator_kind_from_string("dense"), Error);
    EXPECT_THROW(runtime::mass_kind_from_string("none"), Error);
}

}  // namespace
}  // namespace lancet::test
