#include <random>

#include "tests/kernels/rotation/rotation_reference.hpp"
#include "tests/kernels/rotation/rotation_runs.hpp"

namespace lancet::kernels::test {

namespace {

Eigen::Matrix3d with_singular_values(unsigned seed, const Eigen::Vector3d& s) {
    return random_rotation(2 * seed).toRotationMatrix() * s.asDiagonal() *
           random_rotation(2 * seed + 1).toRotationMatrix();
}

std::vector<Eigen::Matrix3d> families() {
    const std::vector<Eigen::Vector3d> singular_values = {
        {1, 1, 1},     {1.1, 1, 0.95},  {3, 2, 1},       {1, 1, 0.01},       {1, 0.01, 0.005}, {1, 0.7, 0},
        {1, 1, -0.5},  {1, 0.5, -0.25}, {1, 0.9, -0.8},  {20, 0.5, 0.1},     {1, 1e-3, 5e-4},  {1, 1e-3, -5e-4},
        {1, 1, -0.99}, {50, 50, 1e-3},  {1e-3, 1e-3, 0}, {1, 0.999, -0.998}, {5, 5, 5},        {1, 0.02, 0.02},
    };
    std::vector<Eigen::Matrix3d> f;
    unsigned seed = 1;
    for (const Eigen::Vector3d& s : singular_values) {
        for (int repeat = 0; repeat < 10; ++repeat) f.push_back(with_singular_values(seed++, s));
    }
    std::mt19937 generator(7);
    std::normal_distribution<double> normal;
    for (int repeat = 0; repeat < 150; ++repeat) {
        f.push_back(Eigen::Matrix3d::NullaryExpr([&] { return normal(generator); }));
    }
    return f;
}

Eigen::Quaterniond turn(double angle, unsigned seed) {
    const Eigen::Vector3d axis = random_rotation(seed).vec().normalized();
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
}

}  // namespace

class RotationAccuracy : public RotationTest {};

// The quadratic form q^T K q is computed with a rounding error of a few eps s1; its maximum moves by that over the gap.
TEST_P(RotationAccuracy, EqualsTheReferenceToRoundingTimesCondition) {
    const RotationRun& run = GetParam();
    const std::vector<Eigen::Matrix3d> f = families();
    std::vector<RotationReference> references;
    std::vector<Eigen::Quaterniond> starts;
    for (std::size_t i = 0; i < f.size(); ++i) {
        references.push_back(rotation_reference(run.rounded(f[i])));
        // The smaller the gap s2 +- s3, the nearer a start must be.
        const double angle = 0.1 / references[i].condition;
        const Eigen::Quaterniond near = Eigen::Quaterniond(references[i].rotation) * turn(angle, 5000 + unsigned(i));
        starts.push_back(run.method == RotationMethod::quaternion ? near : Eigen::Quaterniond::Identity());
    }
    const auto q = decompose(run, f, starts, 3);
    double worst = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
        const double error = (q[i].toRotationMatrix() - references[i].rotation).norm();
        const double bound = 16 * run.epsilon() * (1 + references[i].condition);
        worst = std::max(worst, error / bound);
        EXPECT_LE(error, bound) << "matrix " << i << ", condition " << references[i].condition << "\n" << f[i];
    }
    RecordProperty("worst_error_over_bound", std::to_string(worst));
}

// Whatever the condition, no other rotation may fit F better by more than rounding. (A gap s2 +- s3 below 64 eps s1 is
// not resolved: it may cost twice the gap.)
TEST_P(RotationAccuracy, NoRotationFitsBetter) {
    const RotationRun& run = GetParam();
    std::vector<Eigen::Matrix3d> f = families();
    const std::vector<Eigen::Vector3d> degenerate = {
        {1, 0, 0}, {1, 1e-12, 0}, {1, 1, -1}, {1, 0.3, -0.3}, {1, 1e-6, 0}, {1, 1e-7, -1e-7}, {1, 0.5, -0.4999999}};
    unsigned seed = 9000;
    for (const Eigen::Vector3d& s : degenerate) {
        for (int repeat = 0; repeat < 20; ++repeat) f.push_back(with_singular_values(seed++, s));
    }
    std::vector<Eigen::Quaterniond> starts(f.size(), Eigen::Quaterniond::Identity());
    if (run.method == RotationMethod::quaternion) {
        for (std::size_t i = 0; i < f.size(); ++i) {
            const RotationReference reference = rotation_reference(run.rounded(f[i]));
            starts[i] = Eigen::Quaterniond(reference.rotation) * turn(0.1 / reference.condition, unsigned(i));
        }
    }
    const auto q = decompose(run, f, starts, 3);
    for (std::size_t i = 0; i < f.size(); ++i) {
        const RotationReference reference = rotation_reference(run.rounded(f[i]));
        const double trace = (q[i].toRotationMatrix().transpose() * run.rounded(f[i])).trace();
        EXPECT_GE(trace, reference.largest_trace - 160 * run.epsilon() * reference.size) << "matrix " << i << "\n"
                                                                                         << f[i];
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, RotationAccuracy, ::testing::ValuesIn(rotation_runs()), run_name);

class QuaternionSteps : public RotationTest {};

// From an angle a about a principal axis one step is exact, however long.
TEST_P(QuaternionSteps, OneStepIsExactAboutAPrincipalAxis) {
    RotationRun run = GetParam();
    if (run.method != RotationMethod::quaternion) GTEST_SKIP() << "a property of method quaternion alone";
    std::vector<Eigen::Matrix3d> f;
    std::vector<Eigen::Matrix3d> expected;
    std::vector<Eigen::Quaterniond> starts;
    for (unsigned i = 0; i < 60; ++i) {
        const Eigen::Matrix3d v = random_rotation(300 + i).toRotationMatrix();
        const Eigen::Matrix3d stretch = v * Eigen::Vector3d(1.4, 1, 0.7).asDiagonal() * v.transpose();
        const Eigen::Quaterniond rotation = random_rotation(700 + i);
        const double angle = 1.4 * (i + 1) / 60;
        f.push_back(run.rounded(rotation.toRotationMatrix() * stretch));
        expected.push_back(rotation_reference(f.back()).rotation);
        starts.push_back(Eigen::Quaterniond(expected.back()) * Eigen::AngleAxisd(angle, v.col(int(i % 3))));
    }
    const auto q = decompose(run, f, starts, 1);
    for (std::size_t i = 0; i < f.size(); ++i) {
        // Near a right angle the Hessian has a small eigenvalue, that magnifies the rounding of the start.
        EXPECT_LE((q[i].toRotationMatrix() - expected[i]).norm(), 200 * run.epsilon()) << "number " << i;
    }
}

TEST_P(QuaternionSteps, ErrorFallsWithTheThirdPowerOfTheDistance) {
    RotationRun run = GetParam();
    if (run.method != RotationMethod::quaternion) GTEST_SKIP() << "a property of method quaternion alone";
    for (const double angle : {0.05, 0.1, 0.2, 0.4}) {
        std::vector<Eigen::Matrix3d> f;
        std::vector<Eigen::Matrix3d> expected;
        std::vector<Eigen::Quaterniond> starts;
        for (unsigned i = 0; i < 100; ++i) {
            f.push_back(run.rounded(with_singular_values(100 + i, {1.3, 1, 0.8})));
            expected.push_back(rotation_reference(f.back()).rotation);
            starts.push_back(Eigen::Quaterniond(expected.back()) * turn(angle, i));
        }
        const auto q = decompose(run, f, starts, 1);
        for (std::size_t i = 0; i < f.size(); ++i) {
            EXPECT_LE((q[i].toRotationMatrix() - expected[i]).norm(), 0.2 * angle * angle * angle + 16 * run.epsilon());
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, QuaternionSteps, ::testing::ValuesIn(rotation_runs()), run_name);

}  // namespace lancet::kernels::test
