#include <cmath>
#include <cstring>
#include <limits>

#include "tests/kernels/rotation/rotation_reference.hpp"
#include "tests/kernels/rotation/rotation_runs.hpp"

namespace lancet::kernels::test {

namespace {

bool same_bits(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
    return std::memcmp(a.coeffs().data(), b.coeffs().data(), 4 * sizeof(double)) == 0;
}

// More than three batches of the widest registers, easy ones and hard ones mixed.
std::vector<Eigen::Matrix3d> mixed() {
    std::vector<Eigen::Matrix3d> f;
    for (unsigned i = 0; i < 56; ++i) {
        const Eigen::Vector3d stretch = i % 9 == 4 ? Eigen::Vector3d(1, 0.2, -0.1) : Eigen::Vector3d(1.2, 1, 0.9);
        const Eigen::Quaterniond rotation = i % 7 == 3 ? random_rotation(i) : Eigen::Quaterniond::Identity();
        f.emplace_back(rotation * stretch.asDiagonal() * (i % 11 == 5 ? 1e20 : 1.0));
    }
    return f;
}

}  // namespace

class RotationLanes : public RotationTest {};

TEST_P(RotationLanes, ALaneDoesNotDependOnItsNeighbours) {
    const RotationRun& run = GetParam();
    const std::vector<Eigen::Matrix3d> f = mixed();
    const auto together = decompose_cold(run, f, 1);
    for (std::size_t i = 0; i < f.size(); ++i) {
        EXPECT_TRUE(same_bits(together[i], decompose_cold(run, {f[i]}, 1)[0])) << "matrix " << i;
    }
    std::vector<Eigen::Matrix3d> shifted(f.begin() + 5, f.end());
    const auto again = decompose_cold(run, shifted, 1);
    for (std::size_t i = 0; i < shifted.size(); ++i)
        EXPECT_TRUE(same_bits(together[i + 5], again[i])) << "matrix " << i;
}

TEST_P(RotationLanes, WhatIsNotANumberStaysInItsLane) {
    const RotationRun& run = GetParam();
    const std::vector<Eigen::Matrix3d> f = mixed();
    const auto clean = decompose_cold(run, f, 2);
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        for (std::size_t lane = 0; lane < 32; ++lane) {
            std::vector<Eigen::Matrix3d> spoiled = f;
            spoiled[lane](static_cast<int>(lane % 3), 1) = bad;
            const auto q = decompose_cold(run, spoiled, 2);
            for (std::size_t i = 0; i < f.size(); ++i) {
                if (i == lane) continue;
                EXPECT_TRUE(same_bits(clean[i], q[i])) << "lane " << i << ", spoiled " << lane;
            }
        }
    }
}

TEST_P(RotationLanes, OnlyTheBatchesAskedForAreWritten) {
    const RotationRun& run = GetParam();
    const auto check = [&]<class Real>(Real) {
        const KernelSet<Real>& kernels = kernel_set<Real>(run.instruction_set);
        const std::size_t width = static_cast<std::size_t>(kernels.width);
        std::vector<Real> f(9 * 7 * width, Real(0));
        for (std::size_t i = 0; i < f.size(); ++i) f[i] = i / width % 9 % 4 == 0 ? Real(2) : Real(0.25);
        for (const auto& [begin, end] : {std::pair{2, 5}, std::pair{2, 4}, std::pair{3, 4}, std::pair{3, 3}}) {
            std::vector<Real> q(4 * 7 * width, Real(0.5));
            kernels.rotation.decompose(run.method, 2, f.data(), q.data(), begin, end);
            for (std::size_t i = 0; i < q.size(); ++i) {
                const int batch = static_cast<int>(i / (4 * width));
                if (batch < begin || batch >= end) {
                    EXPECT_EQ(q[i], Real(0.5)) << "batch " << batch;
                } else if (i / width % 4 == 0) {
                    EXPECT_NE(q[i], Real(0.5)) << "batch " << batch;
                }
            }
        }
    };
    run.single ? check(float()) : check(double());
}

INSTANTIATE_TEST_SUITE_P(Methods, RotationLanes, ::testing::ValuesIn(rotation_runs()), run_name);

}  // namespace lancet::kernels::test
