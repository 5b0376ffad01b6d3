// Conjugate gradients against direct solutions with Eigen.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tests/runtime/solve/linear_system.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::test {
namespace {

using runtime::OperatorKind;
using runtime::PreconditionerKind;

constexpr std::array<int, 3> cells{5, 3, 2};

ReferenceSolid fixed_bar() {
    ReferenceSolid solid = jittered_bar(cells, 0.1, 0.15, 151);
    fix_first_section(solid, cells);
    return solid;
}

Eigen::VectorXd deformed(const ReferenceSolid& solid) {
    return solid.rest() + random_vector(solid.unknowns(), 0.01, 152);
}

double condition_of(const Eigen::MatrixXd& matrix) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix, Eigen::EigenvaluesOnly);
    return eigen.eigenvalues().maxCoeff() / eigen.eigenvalues().minCoeff();
}

std::vector<NodeHold> some_holds() {
    return {{17, Eigen::Vector3d::Zero()},
            {23, Eigen::Vector3d(1, 2, -2) / 3},
            {4, Eigen::Vector3d(0, 0, 1)},
            {5, Eigen::Vector3d::Zero()}};
}

class ConjugateGradients : public ArithmeticTest {};
INSTANTIATE_TEST_SUITE_P(Arithmetics, ConjugateGradients, ::testing::ValuesIn(compiled_arithmetics()),
                         ArithmeticName());

TEST_P(ConjugateGradients, ReachTheDirectSolution) {
    with_scalars(GetParam().scalar, [&]<class Real, class Accumulate>() {
        const ReferenceSolid solid = fixed_bar();
        const Eigen::VectorXd b = random_vector(solid.unknowns(), 1, 153);
        const double epsilon = std::numeric_limits<Real>::epsilon();
        // The tolerance leaves a reserve over what the scalar can reach.
        const double tolerance = sizeof(Real) == 8 ? 1e-13 : 1e-6;
        for (const OperatorKind kind : all_operators) {
            for (const PreconditionerKind preconditioner : all_preconditioners) {
                LinearSystem<Real, Accumulate> system(
                    solid, deformed(solid),
                    {.instruction_set = GetParam().instruction_set, .kind = kind, .preconditioner = preconditioner});
                const Eigen::MatrixXd a = system.assembled();
                for (const bool is_held : {false, true}) {
                    SCOPED_TRACE(::testing::Message()
                                 << to_string(kind) << ", " << to_string(preconditioner) << ", held: " << is_held);
                    const std::vector<NodeHold> holds = is_held ? some_holds() : std::vector<NodeHold>();
                    const Eigen::MatrixXd q = allowed_motions(solid, holds);
                    const Eigen::MatrixXd reduced = q.transpose() * a * q;
                    const double allowed_error = 30 * std::max(epsilon, tolerance) * condition_of(reduced);
                    const auto factors = reduced.llt();

                    const auto filter = filter_of(holds, system.numbering);
                    const auto free = system.solve(b, {.iterations = 500, .tolerance = tolerance}, filter);
                    EXPECT_FALSE(free.result.broke_down);
                    EXPECT_LT(free.result.residual, tolerance);
                    const Eigen::VectorXd expected = q * factors.solve(q.transpose() * b);
                    EXPECT_LE((free.x - expected).norm(), allowed_error * expected.norm());

                    // Prescribed values at fixed and held nodes are kept and act on the others.
                    Eigen::VectorXd prescribed = random_vector(solid.unknowns(), 1e-2, 154);
                    prescribed -= (q * (q.transpose() * prescribed)).eval();
                    const auto driven =
                        system.solve(b, {.iterations = 500, .tolerance = tolerance}, filter, prescribed);
                    EXPECT_LT(driven.result.residual, tolerance);
                    const Eigen::VectorXd moved = prescribed + q * factors.solve(q.transpose() * (b - a * prescribed));
                    EXPECT_LE((driven.x - moved).norm(), allowed_error * moved.norm());
                    const Eigen::VectorXd kept = driven.x - q * (q.transpose() * driven.x);
                    EXPECT_LE((kept - prescribed).cwiseAbs().maxCoeff(), 4 * epsilon * driven.x.cwiseAbs().maxCoeff());
                }
            }
        }
    });
}

TEST(ConjugateGradientSettings, ErrorsInTheNormOfTheMatrixDecrease) {
    const ReferenceSolid solid = fixed_bar();
    const Eigen::VectorXd b = random_vector(solid.unknowns(), 1, 155);
    for (const PreconditionerKind preconditioner : all_preconditioners) {
        SCOPED_TRACE(to_string(preconditioner));
        LinearSystem<double, double> system(solid, deformed(solid), {.preconditioner = preconditioner});
        const Eigen::MatrixXd a = system.assembled(), q = allowed_motions(solid, {});
        const Eigen::VectorXd exact = q * (q.transpose() * a * q).llt().solve(q.transpose() * b);
        double previous = std::sqrt(exact.dot(a * exact));
        const double start = previous;
        for (int iterations = 1; iterations <= 40; ++iterations) {
            const auto solution = system.solve(b, {.iterations = iterations, .tolerance = 0});
            EXPECT_EQ(solution.result.iterations, iterations) << "a tolerance of zero asks for all iterations";
            ASSERT_EQ(solution.history.size(), static_cast<std::size_t>(iterations));
            EXPECT_EQ(solution.history.back(), solution.result.residual);
            const Eigen::VectorXd error = solution.x - exact;
            const double size = std::sqrt(error.dot(a * error));
            EXPECT_LE(size, previous * (1 + 1e-9) + 1e-12 * start);
            previous = size;
        }
        EXPECT_LT(previous, 0.05 * start);
    }
}

TEST(ConjugateGradientSettings, TheResidualReportedIsTheTrueOne) {
    const ReferenceSolid solid = fixed_bar();
    const Eigen::VectorXd b = random_vector(solid.unknowns(), 1, 156);
    const Eigen::MatrixXd q = allowed_motions(solid, {});
    for (const PreconditionerKind preconditioner :
         {PreconditionerKind::none, PreconditionerKind::jacobi, PreconditionerKind::block_jacobi}) {
        SCOPED_TRACE(to_string(preconditioner));
        LinearSystem<double, double> system(solid, deformed(solid), {.preconditioner = preconditioner});
        const Eigen::MatrixXd a = system.assembled();
        Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(a.rows(), a.cols());
        for (Eigen::Index i = 0; i < a.rows(); i += 3) {
            if (preconditioner == PreconditionerKind::block_jacobi) {
                inverse.block<3, 3>(i, i) = a.block<3, 3>(i, i).inverse();
            } else if (preconditioner == PreconditionerKind::jacobi) {
                inverse.diagonal().segment<3>(i) = a.diagonal().segment<3>(i).cwiseInverse();
            }
        }
        for (const int iterations : {1, 5, 12}) {
            const auto solution = system.solve(b, {.iterations = iterations, .tolerance = 0});
            const Eigen::VectorXd r = q * (q.transpose() * (b - a * solution.x)), right = q * (q.transpose() * b);
            const double expected = std::sqrt(r.dot(inverse * r) / right.dot(inverse * right));
            EXPECT_NEAR(solution.result.residual, expected, 1e-9 * expected);
        }
    }
}

TEST(ConjugateGradientSettings, TheToleranceIsHonouredAndNoMore) {
    const ReferenceSolid solid = fixed_bar();
    const Eigen::VectorXd b = random_vector(solid.unknowns(), 1, 157);
    LinearSystem<double, double> system(solid, deformed(solid), {});
    int previous = 0;
    for (const double tolerance : {1e-1, 1e-3, 1e-6, 1e-9}) {
        const auto solution = system.solve(b, {.iterations = 300, .tolerance = tolerance});
        EXPECT_LT(solution.result.residual, tolerance);
        ASSERT_GE(solution.history.size(), 2U);
        for (std::size_t k = 0; k + 1 < solution.history.size(); ++k) EXPECT_GE(solution.history[k], tolerance);
        EXPECT_GT(solution.result.iterations, previous);
        previous = solution.result.iterations;
    }
    const auto cut_short = system.solve(b, {.iterations = 3, .tolerance = 1e-9});
    EXPECT_EQ(cut_short.result.iterations, 3);
    EXPECT_GE(cut_short.result.residual, 1e-9);
    EXPECT_FALSE(cut_short.result.broke_down);
}

TEST(ConjugateGradientSettings, ARightHandSideOfZeroNeedsNoIteration) {
    const ReferenceSolid solid = fixed_bar();
    LinearSystem<float, float> system(solid, deformed(solid), {});
    const auto solution = system.solve(Eigen::VectorXd::Zero(solid.unknowns()), {.iterations = 10, .tolerance = 0});
    EXPECT_EQ(solution.result.iterations, 0);
    EXPECT_EQ(solution.result.residual, 0);
    EXPECT_FALSE(solution.result.broke_down);
    EXPECT_EQ(solution.x, Eigen::VectorXd::Zero(solid.unknowns()));
}

class Breakdown : public ::testing::TestWithParam<std::tuple<runtime::ScalarMode, PreconditionerKind>> {};
INSTANTIATE_TEST_SUITE_P(Scalars, Breakdown,
                         ::testing::Combine(::testing::ValuesIn(all_scalars), ::testing::ValuesIn(all_preconditioners)),
                         [](const auto& instance) {
                             return std::string(to_string(std::get<0>(instance.param))) + "_" +
                                    identifier(to_string(std::get<1>(instance.param)));
                         });

TEST_P(Breakdown, OfMatricesThatAreIndefiniteOrNotFiniteIsReported) {
    const auto [scalar, preconditioner] = GetParam();
    with_scalars(scalar, [preconditioner = preconditioner]<class Real, class Accumulate>() {
        const ReferenceSolid solid = fixed_bar();
        const Eigen::VectorXd b = random_vector(solid.unknowns(), 1, 158);
        for (const OperatorKind kind : all_operators) {
            SCOPED_TRACE(to_string(kind));
            LinearSystem<Real, Accumulate> system(solid, deformed(solid),
                                                  {.kind = kind, .preconditioner = preconditioner});
            ASSERT_FALSE(system.solve(b, {.iterations = 20, .tolerance = 0}).result.broke_down);
            // The preconditioner stays that of the definite matrix.
            for (const double mass : {-1000.0, std::numeric_limits<double>::quiet_NaN(), HUGE_VAL}) {
                system.matrix->assemble(*system.scheduler, {.mass = mass, .stiffness = 1e-4});
                const auto solution = system.solve(b, {.iterations = 20, .tolerance = 0});
                EXPECT_TRUE(solution.result.broke_down) << "mass factor " << mass;
                EXPECT_LT(solution.result.iterations, 20);
                EXPECT_TRUE(solution.x.allFinite());
            }
            system.matrix->assemble(*system.scheduler, {.mass = 1, .stiffness = -100});
            const auto solution = system.solve(b, {.iterations = 200, .tolerance = 0});
            EXPECT_TRUE(solution.result.broke_down);
            EXPECT_TRUE(solution.x.allFinite());
            // And a right-hand side that is not a number.
            system.take_up(system.positions);
            Eigen::VectorXd bad = b;
            bad[50] = std::numeric_limits<double>::quiet_NaN();
            EXPECT_TRUE(system.solve(bad, {.iterations = 20, .tolerance = 0}).result.broke_down);
        }
    });
}

TEST(MixedPrecision, IsAsAccurateAsItsOperator) {
    // A long bar at a long step: the condition is large, and what float loses shows.
    const std::array<int, 3> long_cells{24, 2, 2};
    ReferenceSolid solid = jittered_bar(long_cells, 0.1, 0.1, 159);
    fix_first_section(solid, long_cells);
    const Eigen::VectorXd b = random_vector(solid.unknowns(), 1, 160);
    const Eigen::MatrixXd q = allowed_motions(solid, {});
    double condition = 0;
    const auto error = [&]<class Real, class Accumulate>(Real, Accumulate) {
        LinearSystem<Real, Accumulate> system(solid, solid.rest(), {.time_step = 0.2});
        const Eigen::MatrixXd a = q.transpose() * system.assembled() * q;
        if (condition == 0) condition = condition_of(a);
        const Eigen::VectorXd exact = q * a.llt().solve(q.transpose() * b);
        const auto solution = system.solve(b, {.iterations = 300, .tolerance = 0});
        return (solution.x - exact).norm() / exact.norm();
    };
    const double single = error(float(), float()), mixed = error(float(), double()), twice = error(double(), double());
    // Products with the operator are rounded to float in both: residual and solution in double cannot take that back.
    EXPECT_LT(mixed, 2 * single);
    EXPECT_LT(mixed, 0x1p-23 * condition);
    EXPECT_LT(twice, 0x1p-52 * condition);
}

TEST(PreconditionerKind, HasNames) {
    for (const PreconditionerKind kind : all_preconditioners) {
        EXPECT_EQ(runtime::preconditioner_kind_from_string(to_string(kind)), kind);
    }
    EXPECT_THROW(runtime::preconditioner_kind_from_string("multigrid"), Error);
}

}  // namespace
}  // namespace lancet::test
