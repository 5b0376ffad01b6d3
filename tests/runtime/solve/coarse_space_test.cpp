// The coarse space of rigid-body modes, also where aggregates have fewer than six of them.
#include <array>
#include <cmath>
#include <limits>

#include "tests/runtime/solve/linear_system.hpp"
#include <gtest/gtest.h>

namespace lancet::test {
namespace {

using runtime::OperatorKind;
using runtime::PreconditionerKind;

constexpr std::array<int, 3> cells{5, 3, 2};

ReferenceSolid fixed_bar() {
    ReferenceSolid solid = jittered_bar(cells, 0.1, 0.15, 171);
    fix_first_section(solid, cells);
    return solid;
}

/// Shapes that take modes away from aggregates.
struct Shape {
    std::string name;
    Eigen::Vector3d scale;
};
std::vector<Shape> shapes() {
    return {{"sound", {1, 1, 1}}, {"flat", {1, 1, 0}}, {"collinear", {1, 0, 0}}, {"collapsed", {0, 0, 0}}};
}

/// Where all nodes lie on a line or in a point, rotations about it are all as near: the operator's own choice counts.
template <class System>
Eigen::MatrixXd matrix_of(System& system, const Eigen::Vector3d& scale) {
    return scale[1] == 0 ? system.from_products() : system.assembled();
}

class CoarseSpace : public ::testing::TestWithParam<std::tuple<Shape, int, runtime::ScalarMode>> {};
INSTANTIATE_TEST_SUITE_P(ShapesAndAggregates, CoarseSpace,
                         ::testing::Combine(::testing::ValuesIn(shapes()), ::testing::Values(1, 2, 12, 24),
                                            ::testing::ValuesIn(all_scalars)),
                         [](const auto& instance) {
                             return std::get<0>(instance.param).name + "_" +
                                    std::to_string(std::get<1>(instance.param)) + "_nodes_" +
                                    std::string(to_string(std::get<2>(instance.param)));
                         });

TEST_P(CoarseSpace, SolvesForTheModesThatThereAre) {
    const auto& [shape, per_aggregate, scalar] = GetParam();
    with_scalars(
        scalar, [&, scale = shape.scale,
                 options = kernels::NumberingOptions{
                     .nodes_per_block = 24, .nodes_per_aggregate = per_aggregate}]<class Real, class Accumulate>() {
            const ReferenceSolid solid = fixed_bar();
            const Eigen::VectorXd x = moved(solid.rest(), scale.asDiagonal(), {0.01, 0.02, 0.03});
            for (const OperatorKind kind : all_operators) {
                SCOPED_TRACE(to_string(kind));
                LinearSystem<Real, Accumulate> system(solid, x, {.kind = kind, .numbering = options});
                EXPECT_EQ(system.preconditioner.coarse_failures(), 0);
                EXPECT_EQ(system.preconditioner.coarse_refreshes(), 1);
                auto* coarse = system.preconditioner.coarse();
                ASSERT_NE(coarse, nullptr);
                ASSERT_EQ(coarse->unknowns(), 6 * system.numbering.aggregates());

                // Columns: translations and rotations of each aggregate about its centre.
                Eigen::MatrixXd z = Eigen::MatrixXd::Zero(solid.unknowns(), coarse->unknowns());
                for (int g = 0; g < system.numbering.aggregates(); ++g) {
                    std::vector<std::int32_t> nodes;
                    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
                    for (std::int32_t n = system.numbering.aggregate_begin[g];
                         n < system.numbering.aggregate_begin[g + 1]; ++n) {
                        if (system.numbering.user_of_internal[n] < 0) continue;
                        nodes.push_back(system.numbering.user_of_internal[n]);
                        centre += x.segment<3>(3 * nodes.back());
                    }
                    centre /= static_cast<double>(nodes.size());
                    for (const std::int32_t node : nodes) {
                        const Eigen::Vector3d r = x.segment<3>(3 * node) - centre;
                        for (int axis = 0; axis < 3; ++axis) {
                            const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
                            z.block<3, 1>(3 * node, 6 * g + axis) = unit;
                            z.block<3, 1>(3 * node, 6 * g + 3 + axis) = unit.cross(r);
                        }
                    }
                }
                // Z (Z^T A Z)^+ Z^T r, by a basis of the range of Z.
                Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
                qr.setThreshold(1e-6);
                qr.compute(z);
                const Eigen::MatrixXd basis = Eigen::MatrixXd(qr.householderQ()).leftCols(qr.rank());
                const Eigen::MatrixXd galerkin = basis.transpose() * matrix_of(system, scale) * basis;
                const Eigen::VectorXd r = random_vector(solid.unknowns(), 1, 172);
                const Eigen::VectorXd expected = basis * galerkin.ldlt().solve(basis.transpose() * r);

                const Eigen::VectorXd restricted = z.transpose() * r;
                const auto arguments = coarse->arguments();
                std::copy(restricted.begin(), restricted.end(), arguments.restricted);
                coarse->solve();
                Eigen::VectorXd motion(coarse->unknowns());
                for (Eigen::Index i = 0; i < motion.size(); ++i) {
                    motion[i] = static_cast<double>(arguments.correction[i]);
                }
                const Eigen::VectorXd correction = z * motion;
                const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(galerkin, Eigen::EigenvaluesOnly);
                const double condition = eigen.eigenvalues().maxCoeff() / eigen.eigenvalues().minCoeff();
                EXPECT_LE((correction - expected).norm(),
                          30 * static_cast<double>(std::numeric_limits<Real>::epsilon()) * condition * expected.norm());
            }
        });
}

TEST_P(CoarseSpace, PreconditionsWhatItCan) {
    const auto& [shape, per_aggregate, scalar] = GetParam();
    with_scalars(
        scalar, [&, scale = shape.scale, scalar_mode = scalar,
                 options = kernels::NumberingOptions{
                     .nodes_per_block = 24, .nodes_per_aggregate = per_aggregate}]<class Real, class Accumulate>() {
            const ReferenceSolid solid = fixed_bar();
            const Eigen::VectorXd x = moved(solid.rest(), scale.asDiagonal(), {0.01, 0.02, 0.03});
            const Eigen::VectorXd b = random_vector(solid.unknowns(), 1, 173);
            LinearSystem<Real, Accumulate> system(solid, x, {.numbering = options});
            const double tolerance = scalar_mode == runtime::ScalarMode::double_precision ? 1e-12 : 1e-5;
            // An aggregate that is held altogether, too.
            std::vector<NodeHold> holds;
            for (std::int32_t n = system.numbering.aggregate_begin[1]; n < system.numbering.aggregate_begin[2]; ++n) {
                if (system.numbering.user_of_internal[n] < 0) continue;
                holds.push_back({system.numbering.user_of_internal[n], Eigen::Vector3d::Zero()});
            }
            for (const auto& held : {std::vector<NodeHold>(), holds}) {
                const auto solution =
                    system.solve(b, {.iterations = 500, .tolerance = tolerance}, filter_of(held, system.numbering));
                EXPECT_FALSE(solution.result.broke_down);
                EXPECT_LT(solution.result.residual, tolerance);
                const Eigen::MatrixXd q = allowed_motions(solid, held),
                                      reduced = q.transpose() * matrix_of(system, scale) * q;
                const Eigen::VectorXd expected = q * reduced.llt().solve(q.transpose() * b);
                const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(reduced, Eigen::EigenvaluesOnly);
                const double condition = eigen.eigenvalues().maxCoeff() / eigen.eigenvalues().minCoeff();
                EXPECT_LE((solution.x - expected).norm(), 30 * tolerance * condition * expected.norm());
            }
        });
}

TEST(CoarseSpaceOfALongBar, NeedsFarFewerIterationsThanBlockJacobi) {
    const std::array<int, 3> long_cells{40, 2, 2};
    ReferenceSolid solid = jittered_bar(long_cells, 0.1, 0.1, 174);
    fix_first_section(solid, long_cells);
    // Loads of long wavelength, a long step.
    Eigen::VectorXd b = Eigen::VectorXd::Zero(solid.unknowns());
    for (Eigen::Index i = 0; i < b.size(); i += 3) b[i + 1] = 1;
    const auto iterations = [&](PreconditionerKind kind) {
        LinearSystem<float, float> system(solid, solid.rest(),
                                          {.preconditioner = kind,
                                           .numbering = {.nodes_per_block = 40, .nodes_per_aggregate = 20},
                                           .time_step = 0.1});
        const auto solution = system.solve(b, {.iterations = 3000, .tolerance = 1e-4});
        EXPECT_LT(solution.result.residual, 1e-4);
        return solution.result.iterations;
    };
    const int coarse = iterations(PreconditionerKind::coarse), blocks = iterations(PreconditionerKind::block_jacobi);
    EXPECT_LT(4 * coarse, blocks) << coarse << " against " << blocks;
    EXPECT_LE(blocks, iterations(PreconditionerKind::none));
}

TEST(CoarseSpaceRefresh, FollowsTheChangeOfShape) {
    const ReferenceSolid solid = fixed_bar();
    LinearSystem<double, double> system(solid, solid.rest(), {});
    auto* coarse = system.preconditioner.coarse();
    const auto change = [&](const Eigen::VectorXd& x) {
        return coarse->change(*system.scheduler, system.template to_internal<double>(x).data());
    };
    EXPECT_NEAR(change(solid.rest()), 0, 1e-7);
    EXPECT_NEAR(change(moved(solid.rest(), Eigen::Matrix3d::Identity(), {1, -2, 3})), 0, 1e-6);
    // |R r - r| / |r| is at most, and for some aggregate near, 2 sin(angle / 2).
    for (const double angle : {0.1, 0.5, 2.0}) {
        const double found = change(
            moved(solid.rest(), Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix(), {0, 0, 0}));
        EXPECT_LE(found, 2 * std::sin(angle / 2) * (1 + 1e-9));
        EXPECT_GE(found, 1.2 * std::sin(angle / 2));
    }
    EXPECT_NEAR(change(moved(solid.rest(), 1.25 * Eigen::Matrix3d::Identity(), {0, 0, 0})), 0.25, 1e-9);
    Eigen::VectorXd broken = solid.rest();
    broken[30] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(std::isinf(change(broken)));
}

TEST(CoarseSpaceRefresh, OfAMatrixThatIsNotFiniteIsReportedAndHarmless) {
    const ReferenceSolid solid = fixed_bar();
    LinearSystem<double, double> system(solid, solid.rest(), {});
    Eigen::VectorXd broken = solid.rest();
    broken[30] = std::numeric_limits<double>::quiet_NaN();
    system.take_up(broken);
    EXPECT_EQ(system.preconditioner.coarse_failures(), 1);
    const Eigen::VectorXd b = random_vector(solid.unknowns(), 1, 175);
    const auto solution = system.solve(b, {.iterations = 10, .tolerance = 0});
    EXPECT_TRUE(solution.result.broke_down);
    // It recovers.
    system.take_up(solid.rest());
    EXPECT_EQ(system.preconditioner.coarse_failures(), 1);
    EXPECT_FALSE(system.solve(b, {.iterations = 10, .tolerance = 0}).result.broke_down);
}

}  // namespace
}  // namespace lancet::test
