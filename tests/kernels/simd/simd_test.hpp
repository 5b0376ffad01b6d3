#pragma once

#include <string>
#include <vector>

#include "tests/kernels/simd/simd_probe.hpp"
#include <gtest/gtest.h>

namespace lancet::kernels::test {

/// Every case runs in float and double; what this machine cannot execute is skipped.
class SimdTest : public ::testing::TestWithParam<InstructionSet> {
  protected:
    void SetUp() override {
        if (!is_executable(GetParam())) {
            GTEST_SKIP() << "not run: this processor cannot execute " << to_string(GetParam());
        }
    }

    /// Calls check(table) for both scalars.
    template <class Check>
    void for_each_scalar(Check check) {
        check(simd_probe<float>(GetParam()));
        check(simd_probe<double>(GetParam()));
    }
};

inline std::string set_name(const ::testing::TestParamInfo<InstructionSet>& info) {
    return std::string(to_string(info.param));
}

}  // namespace lancet::kernels::test
