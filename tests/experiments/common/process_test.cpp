#include "lancet/experiments/common/process.hpp"

#include <chrono>
#include <csignal>
#include <stop_token>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

ProcessResult shell(const std::string& script) {
    return run_process({.program = "sh", .arguments = {"-c", script}});
}

TEST(RunProcess, CapturesStandardOutput) {
    const ProcessResult result = shell("printf 'one\\ntwo'");
    EXPECT_TRUE(result.succeeded());
    EXPECT_EQ(result.output, "one\ntwo");
}

TEST(RunProcess, CapturesMoreThanAPipeHolds) {
    const ProcessResult result = shell("head -c 3000000 /dev/zero");
    EXPECT_TRUE(result.succeeded());
    EXPECT_EQ(result.output.size(), 3'000'000u);
}

TEST(RunProcess, ForwardsStandardError) {
    testing::internal::CaptureStderr();
    const ProcessResult result = shell("echo out; echo progress >&2");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "progress\n");
    EXPECT_EQ(result.output, "out\n");
}

TEST(RunProcess, PassesArgumentsUntouched) {
    const ProcessResult result =
        run_process({.program = "sh", .arguments = {"-c", "printf '[%s]' \"$@\"", "sh", "a b", "", "*", "\"q\""}});
    EXPECT_EQ(result.output, "[a b][][*][\"q\"]");
}

TEST(RunProcess, StandardInputIsEmpty) {
    EXPECT_EQ(shell("wc -c").output, "0\n");
}

TEST(RunProcess, AddsToTheEnvironmentOrReplacesInIt) {
    ASSERT_EQ(::setenv("LANCET_TEST_KEPT", "kept", 1), 0);
    ASSERT_EQ(::setenv("LANCET_TEST_REPLACED", "old", 1), 0);
    const Command command{.program = "sh",
                          .arguments = {"-c", "echo $LANCET_TEST_KEPT $LANCET_TEST_REPLACED \"$LANCET_TEST_ADDED\""},
                          .environment = {{"LANCET_TEST_REPLACED", "new"}, {"LANCET_TEST_ADDED", "a = b"}}};
    EXPECT_EQ(run_process(command).output, "kept new a = b\n");
}

TEST(RunProcess, ReportsTheExitCode) {
    const ProcessResult result = shell("echo partly; exit 3");
    EXPECT_FALSE(result.succeeded());
    ASSERT_TRUE(std::holds_alternative<Exited>(result.end));
    EXPECT_EQ(std::get<Exited>(result.end).code, 3);
    EXPECT_EQ(result.output, "partly\n");
    EXPECT_EQ(describe(result.end), "exit code 3");
}

TEST(RunProcess, ReportsTheSignal) {
    const ProcessResult result = shell("kill -SEGV $$");
    ASSERT_TRUE(std::holds_alternative<Signalled>(result.end));
    EXPECT_EQ(std::get<Signalled>(result.end).number, SIGSEGV);
    EXPECT_THAT(describe(result.end), HasSubstr("signal 11"));
    EXPECT_FALSE(result.succeeded());
}

TEST(RunProcess, KillsAtItsTimeLimitAndKeepsTheOutput) {
    const auto start = std::chrono::steady_clock::now();
    const ProcessResult result = run_process({.program = "sh",
                                              .arguments = {"-c", "echo started; exec sleep 3600"},
                                              .timeout = std::chrono::milliseconds(300)});
    EXPECT_TRUE(std::holds_alternative<TimedOut>(result.end));
    EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(300));
    EXPECT_FALSE(result.succeeded());
}

TEST(RunProcess, StopsWhenItIsAsked) {
    std::stop_source stop;
    const std::jthread asks([&stop] { stop.request_stop(); });
    const ProcessResult result =
        run_process({.program = "sh", .arguments = {"-c", "exec sleep 3600"}, .stop = stop.get_token()});
    EXPECT_TRUE(std::holds_alternative<Stopped>(result.end));
    EXPECT_EQ(describe(result.end), "stopped");
    EXPECT_FALSE(result.succeeded());
}

TEST(RunProcess, AStopThatNobodyAsksForChangesNothing) {
    const std::stop_source stop;
    EXPECT_EQ(run_process({.program = "echo", .arguments = {"done"}, .stop = stop.get_token()}).output, "done\n");
}

TEST(RunProcess, KillsAProgramThatClosedItsOutput) {
    const ProcessResult result = run_process(
        {.program = "sh", .arguments = {"-c", "exec >&-; exec sleep 3600"}, .timeout = std::chrono::milliseconds(300)});
    EXPECT_TRUE(std::holds_alternative<TimedOut>(result.end));
}

TEST(RunProcess, AGenerousTimeLimitChangesNothing) {
    const ProcessResult result =
        run_process({.program = "sh", .arguments = {"-c", "echo done"}, .timeout = std::chrono::hours(24 * 365)});
    EXPECT_TRUE(result.succeeded());
    EXPECT_EQ(result.output, "done\n");
}

TEST(RunProcess, SaysWhatItCannotStart) {
    EXPECT_THAT([] { return run_process({.program = "/no/such/program"}); },
                ThrowsMessage<Error>("cannot start '/no/such/program': No such file or directory"));
}

TEST(RunProcess, LeavesNoDescriptorsOpen) {
    const auto next_descriptor = [] {
        const int number = ::dup(STDERR_FILENO);
        ::close(number);
        return number;
    };
    const int before = next_descriptor();
    for (int run = 0; run < 20; ++run) EXPECT_TRUE(shell("true").succeeded());
    EXPECT_THROW((void)run_process({.program = "/no/such/program"}), Error);
    EXPECT_EQ(next_descriptor(), before);
}

TEST(ThisProgram, IsTheTestItself) {
    EXPECT_EQ(this_program().filename(), "test_experiments_common");
}

}  // namespace
}  // namespace lancet::experiments
