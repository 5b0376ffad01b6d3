#pragma once

#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "lancet/kernels/isa/kernel_set.hpp"

namespace lancet::kernels::test {

/// One method of one instruction set and scalar type.
struct RotationRun {
    InstructionSet instruction_set;
    bool single;
    RotationMethod method;

    double epsilon() const { return single ? 0x1p-23 : 0x1p-52; }
    /// F as the kernel sees it.
    Eigen::Matrix3d rounded(const Eigen::Matrix3d& f) const;
};

/// Every method for float and double in every instruction set that is compiled in.
std::vector<RotationRun> rotation_runs();

/// "avx2_float_polar"
std::string run_name(const ::testing::TestParamInfo<RotationRun>& info);

/// Finds the rotation of every F from its start, through the kernel set; the last batch is filled by repeating.
std::vector<Eigen::Quaterniond> decompose(const RotationRun& run, const std::vector<Eigen::Matrix3d>& f,
                                          const std::vector<Eigen::Quaterniond>& start, int steps);

/// The same from the identity.
std::vector<Eigen::Quaterniond> decompose_cold(const RotationRun& run, const std::vector<Eigen::Matrix3d>& f,
                                               int steps = 2);

/// Skips what this machine cannot execute.
class RotationTest : public ::testing::TestWithParam<RotationRun> {
  protected:
    void SetUp() override {
        if (!is_executable(GetParam().instruction_set)) {
            GTEST_SKIP() << "not run: this processor cannot execute " << to_string(GetParam().instruction_set);
        }
    }
};

}  // namespace lancet::kernels::test
