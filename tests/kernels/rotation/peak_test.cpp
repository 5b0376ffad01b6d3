#include <cmath>

#include <gtest/gtest.h>

#include "lancet/kernels/isa/kernel_set.hpp"

namespace lancet::kernels {

class Peak : public ::testing::TestWithParam<InstructionSet> {
  protected:
    void SetUp() override {
        if (!is_executable(GetParam())) {
            GTEST_SKIP() << "not run: this processor cannot execute " << to_string(GetParam());
        }
    }
};

template <class Real>
void expect_closed_form(InstructionSet instruction_set) {
    const PeakKernels<Real>& peak = kernel_set<Real>(instruction_set).peak;
    const int width = kernel_set<Real>(instruction_set).width;
    const int chains = static_cast<int>(peak.operations_per_iteration / (2.0 * width));
    ASSERT_EQ(2.0 * width * chains, peak.operations_per_iteration);
    // a_n = m^n (a_0 - b / (1 - m)) + b / (1 - m), over the mean of the starts
    const double start = 1 + (chains - 1) / 128.0;
    for (const int iterations : {0, 1, 7, 40}) {
        const double fixed = 0.125 / (1 - 0.5);
        const double expected = std::pow(0.5, iterations) * (start - fixed) + fixed;
        EXPECT_NEAR(peak.run(iterations, Real(0.5), Real(0.125)), expected, 1e-6);
    }
}

TEST_P(Peak, RunsEveryIterationOfEveryChain) {
    expect_closed_form<float>(GetParam());
    expect_closed_form<double>(GetParam());
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, Peak, ::testing::ValuesIn(compiled_instruction_sets()),
                         [](const auto& tested) { return std::string(to_string(tested.param)); });

}  // namespace lancet::kernels
