// The critical step of the explicit integrators against dense eigenvalues and against what it predicts.
#include "lancet/runtime/solve/critical_step.hpp"

#include <array>
#include <cmath>
#include <sstream>

#include "tests/runtime/solve/bodies_under_test.hpp"
#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::test {
namespace {

using runtime::ElementModel;
using runtime::Integrator;

constexpr std::array<int, 3> cells{5, 2, 2};

double largest_eigenvalue_of(const ReferenceSolid& solid, const Eigen::VectorXd& position, ElementModel model) {
    const auto tangent =
        model == ElementModel::st_venant_kirchhoff ? runtime::TangentKind::exact : runtime::TangentKind::rotated;
    const std::vector<std::uint8_t> is_free = solid.free_unknowns();
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
        restricted(solid.stiffness(position, model, tangent), is_free), restricted(solid.mass(false), is_free),
        Eigen::EigenvaluesOnly);
    return eigen.eigenvalues().maxCoeff();
}

TEST(Lanczos, FindsTheLargestEigenvalueFromBelowAndBoundsItFromAbove) {
    for (const Eigen::Index size : {1, 2, 7, 60, 300}) {
        const Eigen::MatrixXd random = random_vector(size * size, 1, 4).reshaped(size, size);
        const Eigen::MatrixXd matrix = random + random.transpose();
        const double exact =
            Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
        const Eigen::VectorXd start = random_vector(size, 1, 5);
        const auto product = [&](std::span<const double> x, std::span<double> y) {
            Eigen::VectorXd::Map(y.data(), size) = matrix * Eigen::VectorXd::Map(x.data(), size);
        };
        const double rounding = 1e-12 * std::abs(exact);
        for (const int iterations : {3, 10, 150}) {
            const runtime::LargestEigenvalue found =
                runtime::largest_eigenvalue(std::span<const double>(start.data(), static_cast<std::size_t>(size)),
                                            product, {.tolerance = 1e-8, .iterations = iterations});
            EXPECT_LE(found.estimate, exact + rounding);
            if (iterations == 150 || iterations >= size) {
                EXPECT_GE(found.upper_bound, exact - rounding);
            }
            if (iterations == 150) {
                EXPECT_NEAR(found.estimate, exact, 1e-6 * std::abs(exact)) << size;
            }
            EXPECT_LE(found.iterations, iterations);
        }
    }
}

TEST(Lanczos, FromNothingFindsNothing) {
    const std::vector<double> zero(5, 0.0);
    const auto found = runtime::largest_eigenvalue(
        zero, [](std::span<const double>, std::span<double>) { ADD_FAILURE() << "no product is needed"; });
    EXPECT_EQ(found.estimate, 0);
    EXPECT_EQ(found.upper_bound, 0);
}

TEST(CriticalStep, FollowsItsFormula) {
    EXPECT_DOUBLE_EQ(runtime::critical_step(1e6), 2e-3);
    // xi = (10 / 1000 + 1e-3 * 1000) / 2 = 0.505.
    EXPECT_NEAR(runtime::critical_step(1e6, 10, 1e-3), 2e-3 * (std::sqrt(1 + 0.505 * 0.505) - 0.505), 1e-17);
    EXPECT_EQ(runtime::critical_step(0), HUGE_VAL);
    EXPECT_THROW(runtime::critical_step(1e6, -1), Error);
    EXPECT_THROW(runtime::critical_step(std::nan("")), Error);
}

using BodyChoice = std::tuple<Integrator, ElementModel, runtime::ScalarMode>;

std::string name_of(const BodyChoice& choice) {
    const auto& [integrator, model, scalar] = choice;
    return identifier(to_string(integrator)) + "_" + identifier(to_string(model)) + "_" +
           std::string(to_string(scalar));
}

class CriticalStepOf : public ::testing::TestWithParam<BodyChoice> {};
INSTANTIATE_TEST_SUITE_P(Bodies, CriticalStepOf,
                         ::testing::Combine(::testing::Values(Integrator::implicit_euler,
                                                              Integrator::central_differences),
                                            ::testing::ValuesIn(all_models), ::testing::ValuesIn(all_scalars)),
                         [](const auto& instance) { return name_of(instance.param); });

TEST_P(CriticalStepOf, ABodyIsThatOfTheAssembledMatrices) {
    const auto& [integrator, model, scalar] = GetParam();
    ReferenceSolid solid = jittered_bar(cells, 0.1, 0.15, 191);
    fix_first_section(solid, cells);
    runtime::Settings settings = accurate_settings();
    settings.integrator = integrator;
    set_model(settings, model);
    settings.scalar = scalar;
    settings.energy_safeguard = false;
    settings.time_step = 1e-5;
    const auto scheduler = serial();
    const auto body = make_body(scene_of(solid), settings, *scheduler);
    const std::vector<std::uint8_t> is_free = solid.free_unknowns();
    const Eigen::VectorXd position =
        solid.rest() + extended(restricted(random_vector(solid.unknowns(), 0.01, 192), is_free), is_free);
    body->set_positions(as_points(position));
    const double expected = 2 / std::sqrt(largest_eigenvalue_of(solid, position, model));
    const double found = body->critical_time_step(*scheduler);
    const double tolerance = scalar == runtime::ScalarMode::double_precision ? 1e-6 : 5e-6;
    EXPECT_NEAR(found, expected, tolerance * expected);
    EXPECT_LE(found, expected * (1 + 1e-12)) << "never too long";
}

TEST(CriticalStep, DividesStableFromUnstableSteps) {
    ReferenceSolid solid = jittered_bar(cells, 0.1, 0.15, 193);
    fix_first_section(solid, cells);
    const auto scheduler = serial();
    for (const Integrator integrator : {Integrator::symplectic_euler, Integrator::central_differences}) {
        for (const ElementModel model : all_models) {
            runtime::Settings settings = accurate_settings();
            settings.integrator = integrator;
            set_model(settings, model);
            settings.energy_safeguard = false;
            settings.time_step = 1e-5;
            settings.force_time_step = true;
            const double critical = make_body(scene_of(solid), settings, *scheduler)->critical_time_step(*scheduler);
            for (const double share : {0.99, 1.01}) {
                SCOPED_TRACE(::testing::Message() << to_string(integrator) << ", " << share);
                settings.time_step = share * critical;
                const auto body = make_body(scene_of(solid), settings, *scheduler);
                body->set_velocities(as_points(random_vector(solid.unknowns(), 1e-3, 194)));
                const double start = body->energies(*scheduler).total();
                double largest = 0;
                for (int step = 0; step < 2000; ++step) {
                    body->step(*scheduler);
                    const double energy = body->energies(*scheduler).total();
                    largest = std::isfinite(energy) ? std::max(largest, energy) : HUGE_VAL;
                    if (largest > 1e6 * start) break;
                }
                // Below, each mode keeps a quadratic form of v and omega x with eigenvalues between 1 - 0.99 and
                // 1 + 0.99 times those of its energy. Above, the highest mode grows by 1.33 a step.
                if (share < 1) {
                    EXPECT_LE(largest, start * (1 + 0.99) / (1 - 0.99));
                } else {
                    EXPECT_GT(largest, 1e3 * start);
                }
            }
        }
    }
}

TEST(CriticalStep, LongerStepsAreRefusedWithBothNumbers) {
    ReferenceSolid solid = jittered_bar(cells, 0.1, 0.15, 195);
    fix_first_section(solid, cells);
    const auto scheduler = serial();
    for (const Integrator integrator : {Integrator::symplectic_euler, Integrator::central_differences}) {
        for (const ElementModel model : all_models) {
            SCOPED_TRACE(::testing::Message() << to_string(integrator) << ", " << to_string(model));
            runtime::Settings settings = accurate_settings();
            settings.integrator = integrator;
            set_model(settings, model);
            settings.energy_safeguard = false;
            settings.time_step = 0.04;
            const double critical = 2 / std::sqrt(largest_eigenvalue_of(solid, solid.rest(), model));
            std::ostringstream number;
            number << critical;
            try {
                make_body(scene_of(solid), settings, *scheduler);
                ADD_FAILURE() << "no error";
            } catch (const Error& error) {
                EXPECT_THAT(error.what(), ::testing::HasSubstr("0.04 s"));
                EXPECT_THAT(error.what(), ::testing::HasSubstr(number.str().substr(0, 6)));
            }
            settings.time_step = 1.00001 * critical;
            EXPECT_THROW(make_body(scene_of(solid), settings, *scheduler), Error);
            settings.force_time_step = true;
            EXPECT_NO_THROW(make_body(scene_of(solid), settings, *scheduler));
            settings.force_time_step = false;
            settings.time_step = 0.99999 * critical;
            EXPECT_NO_THROW(make_body(scene_of(solid), settings, *scheduler));
        }
    }
}

TEST(CriticalStep, OfABodyWithoutFreeNodesIsInfiniteAndOfAConsistentMassRefused) {
    ReferenceSolid solid = jittered_bar({2, 1, 1}, 0.1, 0.1, 196);
    const auto scheduler = serial();
    runtime::Settings settings = accurate_settings();
    settings.mass = runtime::MassKind::consistent;
    EXPECT_THROW(make_body(scene_of(solid), settings, *scheduler)->critical_time_step(*scheduler), Error);
    settings.mass = runtime::MassKind::lumped;
    for (std::int32_t node = 0; node < static_cast<std::int32_t>(solid.nodes.size()); ++node) {
        solid.fixed.push_back(node);
    }
    EXPECT_EQ(make_body(scene_of(solid), settings, *scheduler)->critical_time_step(*scheduler), HUGE_VAL);
}

}  // namespace
}  // namespace lancet::test
