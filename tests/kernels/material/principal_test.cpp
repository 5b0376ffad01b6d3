// Principal stretches, derivatives of energies by them, and the positive part of a symmetric matrix.
#include <algorithm>
#include <cmath>

#include "tests/kernels/material/material_run.hpp"

namespace lancet::kernels::test {
namespace {

std::vector<MaterialRun> isotropic_runs() {
    std::vector<MaterialRun> runs = material_runs();
    std::erase_if(runs, [](const MaterialRun& run) { return run.model == MaterialModel::linear; });
    return runs;
}

class Principal : public MaterialTest {};
INSTANTIATE_TEST_SUITE_P(Runs, Principal, ::testing::ValuesIn(isotropic_runs()), run_name);

const std::vector<Eigen::Vector3d> stretches{{1, 1, 1},        {1.2, 0.9, 0.7},  {3, 1.5, 0.4},
                                             {1.2, 0.8, -0.5}, {0.9, 1.3, 1e-3}, {1.1, 1.1, 1.1 + 1e-5}};

TEST_P(Principal, DerivativesAreThoseOfTheEnergy) {
    // In double, of the textbook energy of a diagonal F; the steps balance rounding and truncation.
    const PointwiseReference reference = GetParam().reference();
    const auto energy = [&](const Eigen::Vector3d& s) { return reference.energy(Eigen::Matrix3d(s.asDiagonal())); };
    for (const Eigen::Vector3d& given : stretches) {
        const Eigen::Vector3d s = GetParam().arithmetic.rounded(Eigen::Matrix3d(given.asDiagonal())).diagonal();
        const PrincipalValues values = principal(GetParam(), s);
        const double size = 10 * (1 + s.squaredNorm()) * (1 + s.squaredNorm());
        const double rounding = 8 * epsilon() * size;
        for (int i = 0; i < 3; ++i) {
            const Eigen::Vector3d di = 1e-5 * Eigen::Vector3d::Unit(i);
            EXPECT_NEAR(values.first[i], (energy(s + di) - energy(s - di)) / 2e-5, 1e-9 * size + rounding);
            for (int j = 0; j < 3; ++j) {
                const Eigen::Vector3d ei = 1e-3 * Eigen::Vector3d::Unit(i), ej = 1e-3 * Eigen::Vector3d::Unit(j);
                const double difference =
                    (energy(s + ei + ej) - energy(s + ei - ej) - energy(s - ei + ej) + energy(s - ei - ej)) / 4e-6;
                EXPECT_NEAR(values.second(i, j), difference, 1e-6 * size + rounding);
            }
        }
    }
}

TEST_P(Principal, FlipsAndTwistsAreQuotientsOfTheFirstDerivatives) {
    for (const Eigen::Vector3d& given : stretches) {
        const Eigen::Vector3d s = GetParam().arithmetic.rounded(Eigen::Matrix3d(given.asDiagonal())).diagonal();
        const PrincipalValues values = principal(GetParam(), s);
        const double rounding = 16 * epsilon() * (1 + s.squaredNorm()) * (1 + s.norm()) * (2 + 3 * lambda_over_mu);
        for (int k = 0; k < 3; ++k) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            EXPECT_NEAR(values.flip[k] * (s[i] - s[j]), values.first[i] - values.first[j], rounding);
            EXPECT_NEAR(values.twist[k] * (s[i] + s[j]), values.first[i] + values.first[j], rounding);
        }
        // Where two stretches are equal the quotient is a second derivative: W_ii - W_ij.
        if (given == stretches[0]) {
            EXPECT_NEAR(values.flip[0], values.second(1, 1) - values.second(1, 2), rounding);
        }
    }
}

class PrincipalStretches : public ::testing::TestWithParam<MaterialArithmetic> {
  protected:
    void SetUp() override {
        if (!is_executable(GetParam().instruction_set)) {
            GTEST_SKIP() << "not run: this processor cannot execute " << to_string(GetParam().instruction_set);
        }
    }
};
INSTANTIATE_TEST_SUITE_P(Arithmetics, PrincipalStretches, ::testing::ValuesIn(material_arithmetics()),
                         [](const auto& run) { return run.param.name(); });

TEST_P(PrincipalStretches, AndProperFramesGiveTheDeformationBack) {
    std::vector<Eigen::Matrix3d> f = gradients_of(material_states());
    for (unsigned seed = 0; seed < 200; ++seed) f.push_back(random_matrix(seed));
    f.push_back(Eigen::Matrix3d::Zero());
    f.push_back(Eigen::Vector3d(1, 0, 0).asDiagonal());
    f.push_back(random_rotation(5) * Eigen::Vector3d(2, 0, 0).asDiagonal() * random_rotation(6));
    const double epsilon = GetParam().epsilon();
    const std::vector<Decomposition> all = decompose(GetParam(), f);
    for (std::size_t k = 0; k < f.size(); ++k) {
        SCOPED_TRACE(k);
        const Decomposition& d = all[k];
        const Eigen::Matrix3d back = d.left * d.stretch.asDiagonal() * d.right.transpose();
        EXPECT_LE((back - f[k]).norm(), 16 * epsilon * f[k].norm());
        for (const Eigen::Matrix3d& frame : {d.left, d.right}) {
            EXPECT_LE((frame.transpose() * frame - Eigen::Matrix3d::Identity()).norm(), 24 * epsilon);
            EXPECT_GT(frame.determinant(), 0);
        }
        // Only the least of the stretches is negative, and only where det F < 0.
        Eigen::Vector3d sorted = d.stretch;
        std::sort(sorted.begin(), sorted.end());
        EXPECT_GE(sorted[0] + sorted[1], -16 * epsilon * f[k].norm());
    }
}

TEST_P(PrincipalStretches, PositivePartClampsEigenvalues) {
    std::vector<Eigen::Matrix3d> a;
    const auto add = [&](const Eigen::Matrix3d& m) { a.push_back(GetParam().rounded(0.5 * (m + m.transpose()))); };
    for (unsigned seed = 0; seed < 200; ++seed) add(random_matrix(seed));
    for (unsigned seed = 0; seed < 20; ++seed) {
        const Eigen::Matrix3d m = random_matrix(seed);
        add(m * m.transpose() + 0.1 * Eigen::Matrix3d::Identity());
        add(-a.back());
    }
    add(Eigen::Matrix3d::Zero());
    add(Eigen::Vector3d(2, 2, 2 - 1e-3).asDiagonal());
    add(Eigen::Matrix3d::Constant(1.5));
    const std::vector<Eigen::Matrix3d> clamped = positive_part(GetParam(), a);
    int kept = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(a[k]);
        const Eigen::Matrix3d expected =
            eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
        EXPECT_LE((clamped[k] - expected).norm(), 16 * GetParam().epsilon() * a[k].norm());
        if (eigen.eigenvalues()[0] > 0.05) {
            ++kept;
            EXPECT_EQ(clamped[k], a[k]) << "a positive definite matrix stays to the bit";
        }
    }
    EXPECT_GE(kept, 20);
}

}  // namespace
}  // namespace lancet::kernels::test
