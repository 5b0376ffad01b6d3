#include "lancet/experiments/common/main.hpp"

#include <array>
#include <new>
#include <sstream>
#include <stdexcept>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments {
namespace {

struct Outcome {
    int code;
    std::string errors;
};

Outcome run(const MainFunction& body) {
    constexpr std::array<const char*, 2> arguments{"/usr/bin/bar", "--quick"};
    std::ostringstream errors;
    const int code = run_main(static_cast<int>(arguments.size()), arguments.data(), body, errors);
    return {code, errors.str()};
}

TEST(RunMain, PassesArgumentsAndCodesThrough) {
    const Outcome outcome = run([](int argc, const char* const* argv) {
        EXPECT_EQ(argc, 2);
        EXPECT_STREQ(argv[1], "--quick");
        return ExitCode::success;
    });
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.errors, "");
    EXPECT_EQ(run([](int, const char* const*) { return ExitCode::check_failed; }).code, 1);
}

TEST(RunMain, AFailedCheckIsOne) {
    const Outcome outcome = run([](int, const char* const*) -> ExitCode { throw CheckFailed("error of 3 %"); });
    EXPECT_EQ(outcome.code, 1);
    EXPECT_EQ(outcome.errors, "bar: check failed: error of 3 %\n");
}

TEST(RunMain, BadInputIsTwoAndOneLine) {
    const Outcome outcome = run([](int, const char* const*) -> ExitCode { throw Error("a.msh:3: no\nnumber"); });
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.errors, "bar: error: a.msh:3: no number\n");
}

TEST(RunMain, ExhaustedMemoryIsSaidPlainly) {
    const Outcome outcome = run([](int, const char* const*) -> ExitCode { throw std::bad_alloc(); });
    EXPECT_EQ(outcome.code, 2);
    EXPECT_NE(outcome.errors.find("not enough memory"), std::string::npos);
}

TEST(RunMain, AnyOtherExceptionIsTwo) {
    EXPECT_EQ(run([](int, const char* const*) -> ExitCode { throw std::out_of_range("at"); }).code, 2);
}

}  // namespace
}  // namespace lancet::experiments
