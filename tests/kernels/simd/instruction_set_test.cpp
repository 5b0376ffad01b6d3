#include <array>
#include <cmath>
#include <cstdlib>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "lancet/kernels/error.hpp"
#include "lancet/kernels/isa/kernel_set.hpp"

// The choice is made once per process: each of these cases makes it in a process of its own. Nothing in this program
// may ask for the active instruction set outside of one.

namespace lancet::kernels {

namespace {

/// What the peak kernel of these kernels must return to the last bit if a multiply-add rounds once or twice.
template <class Real>
Real expected_peak(const KernelSet<Real>& kernels, int iterations, Real multiplier, Real addend, bool fused) {
    const int chains = static_cast<int>(kernels.peak.operations_per_iteration / (2.0 * kernels.width));
    Real total = 0;
    for (int c = 0; c < chains; ++c) {
        Real value = 1 + Real(c) / 64;
        for (int i = 0; i < iterations; ++i) {
            const Real product = value * multiplier;
            value = fused ? std::fma(value, multiplier, addend) : product + addend;
        }
        total += value * Real(kernels.width);  // exact: the width is a power of two
    }
    return total / Real(chains * kernels.width);
}

/// Runs the arithmetic and says whether its bits are those of one rounding or of two.
template <class Real>
std::string rounding(const KernelSet<Real>& kernels) {
    const Real multiplier = Real(0.7);
    const Real addend = Real(-0.31);
    const Real fused = expected_peak(kernels, 5, multiplier, addend, true);
    const Real unfused = expected_peak(kernels, 5, multiplier, addend, false);
    const Real measured = kernels.peak.run(5, multiplier, addend);
    if (fused == unfused) return "indistinguishable";
    return measured == fused ? "fused" : measured == unfused ? "unfused" : "neither";
}

/// What ran, as one word for every fact: name, lanes in float and double, fused or not.
std::string evidence() {
    const InstructionSet active = active_instruction_set();
    const auto& single = kernel_set<float>(active);
    const auto& twice = kernel_set<double>(active);
    return std::string(to_string(single.instruction_set)) + " " + std::string(to_string(twice.instruction_set)) + " " +
           std::to_string(single.width) + " " + std::to_string(twice.width) + " " + rounding(single) + " " +
           rounding(twice);
}

/// What a new process says with LANCET_ISA set so (nullptr: unset): its evidence, or the message of the error.
std::string run_with(const char* name) {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) return "no pipe";
    const pid_t child = fork();
    if (child == 0) {
        name == nullptr ? unsetenv("LANCET_ISA") : setenv("LANCET_ISA", name, 1);
        std::string answer;
        try {
            answer = evidence();
        } catch (const Error& error) {
            answer = std::string("error: ") + error.what();
        }
        const bool written = write(ends[1], answer.data(), answer.size()) == static_cast<ssize_t>(answer.size());
        _exit(written ? 0 : 1);
    }
    close(ends[1]);
    std::string answer;
    std::array<char, 512> buffer{};
    for (ssize_t count = 0; (count = read(ends[0], buffer.data(), buffer.size())) > 0;) {
        answer.append(buffer.data(), static_cast<std::size_t>(count));
    }
    close(ends[0]);
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? answer : "the process failed";
}

std::string expected_evidence(InstructionSet set) {
    const std::string name(to_string(set));
    switch (set) {
        case InstructionSet::scalar:
            return name + " " + name + " 1 1 unfused unfused";
        case InstructionSet::sse2:
            return name + " " + name + " 4 2 unfused unfused";
        case InstructionSet::avx2:
            return name + " " + name + " 8 4 fused fused";
        case InstructionSet::avx512:
            return name + " " + name + " 16 8 fused fused";
        case InstructionSet::neon:
            return name + " " + name + " 4 2 fused fused";
    }
    return "unknown";
}

bool is_compiled(InstructionSet set) {
    for (const InstructionSet compiled : compiled_instruction_sets()) {
        if (compiled == set) return true;
    }
    return false;
}

}  // namespace

class ForcedInstructionSet : public ::testing::TestWithParam<InstructionSet> {};

TEST_P(ForcedInstructionSet, TheEnvironmentVariableDecidesWhatRuns) {
    const InstructionSet set = GetParam();
    const std::string name(to_string(set));
    const std::string answer = run_with(name.c_str());
    if (!is_compiled(set)) {
        EXPECT_THAT(answer, ::testing::StartsWith("error: environment variable LANCET_ISA: "));
        EXPECT_THAT(answer, ::testing::HasSubstr(name + " is not compiled in"));
    } else if (!is_executable(set)) {
        EXPECT_THAT(answer, ::testing::HasSubstr("cannot execute instruction set " + name));
        GTEST_SKIP() << "not run: this processor cannot execute " << name << " (the refusal was tested)";
    } else {
        EXPECT_EQ(answer, expected_evidence(set));
    }
}

INSTANTIATE_TEST_SUITE_P(All, ForcedInstructionSet,
                         ::testing::Values(InstructionSet::scalar, InstructionSet::sse2, InstructionSet::avx2,
                                           InstructionSet::avx512, InstructionSet::neon),
                         [](const auto& tested) { return std::string(to_string(tested.param)); });

TEST(ActiveInstructionSet, IsTheWidestExecutableOneByDefault) {
    InstructionSet widest = InstructionSet::scalar;
    for (const InstructionSet set : compiled_instruction_sets()) {
        if (is_executable(set)) widest = set;
    }
    EXPECT_EQ(run_with(nullptr), expected_evidence(widest));
    EXPECT_EQ(run_with(""), expected_evidence(widest));
}

TEST(ActiveInstructionSet, RefusesAnUnknownName) {
    const std::string answer = run_with("avx1024");
    EXPECT_THAT(answer, ::testing::HasSubstr("LANCET_ISA"));
    EXPECT_THAT(answer, ::testing::HasSubstr("unknown instruction set 'avx1024'"));
}

TEST(InstructionSetNames, AreInverse) {
    for (const char* name : {"scalar", "sse2", "avx2", "avx512", "neon"}) {
        EXPECT_EQ(to_string(instruction_set_from_string(name)), name);
    }
    EXPECT_THROW(instruction_set_from_string("AVX2"), Error);
    EXPECT_THROW(instruction_set_from_string(""), Error);
}

}  // namespace lancet::kernels
