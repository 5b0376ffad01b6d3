#include "lancet/runtime/observe/machine_stamp.hpp"

#include <cstdlib>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lancet/runtime/observe/machine_stamp_json.hpp"

namespace lancet::runtime {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;
using ::testing::StartsWith;

#if defined(__clang__)
const std::string major_version = std::to_string(__clang_major__);
#else
const std::string major_version = std::to_string(__GNUC__);
#endif

TEST(MachineStamp, TellsTheBuild) {
    const MachineStamp stamp = machine_stamp("scalar", SchedulerKind::tbb, 2);
    EXPECT_THAT(stamp.version, MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
    EXPECT_THAT(stamp.commit, AnyOf("unknown", MatchesRegex("[0-9a-f]{40}")));
    EXPECT_THAT(stamp.compiler, MatchesRegex("(GNU|Clang|AppleClang) [0-9.]+"));
    EXPECT_THAT(stamp.compiler, MatchesRegex("[A-Za-z]+ " + major_version + "\\..*"));
    EXPECT_THAT(stamp.flags, HasSubstr("-ffp-contract=off"));
    EXPECT_THAT(stamp.flags, Not(HasSubstr("$<")));
    EXPECT_FALSE(stamp.build_type.empty());
}

TEST(MachineStamp, TellsTheMachineAndTheMoment) {
    const MachineStamp stamp = machine_stamp("sse2", SchedulerKind::threads, 3);
    EXPECT_EQ(stamp.instruction_set, "sse2");
    EXPECT_EQ(stamp.scheduler, "threads");
    EXPECT_EQ(stamp.threads, 3);
    EXPECT_GE(stamp.load_average[0], 0);
    EXPECT_FALSE(stamp.cpu_model.empty());
    EXPECT_GE(stamp.cores_online, 1);
    EXPECT_GE(stamp.cores_allowed, 1);
    EXPECT_LE(stamp.cores_allowed, stamp.cores_online);
    EXPECT_THAT(stamp.kernel, MatchesRegex("Linux .+ .+"));
    EXPECT_THAT(stamp.date, MatchesRegex("20[0-9]{2}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}Z"));
    if (stamp.l1_bytes > 0 && stamp.l2_bytes > 0) {
        EXPECT_GE(stamp.l1_bytes, 4096U);
        EXPECT_GE(stamp.l2_bytes, stamp.l1_bytes);
    }
}

TEST(MachineStamp, AddsTheFlagsOfTheActiveInstructionSet) {
    const std::string common = machine_stamp("none", SchedulerKind::serial, 1).flags;
    const std::string scalar = machine_stamp("scalar", SchedulerKind::serial, 1).flags;
    EXPECT_THAT(scalar, StartsWith(common + " -fno-tree-vectorize -fno-tree-slp-vectorize"));
    EXPECT_THAT(common, Not(HasSubstr("-fno-tree-vectorize")));
}

TEST(MachineStamp, ReadsTheWaitPolicyWhenItIsMade) {
    const char* const found = std::getenv("OMP_WAIT_POLICY");
    const std::string before = found == nullptr ? "" : found;
    setenv("OMP_WAIT_POLICY", "passive", 1);
    EXPECT_EQ(machine_stamp("scalar", SchedulerKind::openmp, 1).omp_wait_policy, "passive");
    unsetenv("OMP_WAIT_POLICY");
    EXPECT_EQ(machine_stamp("scalar", SchedulerKind::openmp, 1).omp_wait_policy, "unset");
    if (found != nullptr) setenv("OMP_WAIT_POLICY", before.c_str(), 1);
}

TEST(MachineStamp, BecomesAnObject) {
    const MachineStamp stamp = machine_stamp("scalar", SchedulerKind::serial, 1);
    const nlohmann::json json = stamp;
    EXPECT_EQ(json.size(), 19U);
    EXPECT_EQ(json.at("commit"), stamp.commit);
    EXPECT_EQ(json.at("dirty"), stamp.dirty);
    EXPECT_EQ(json.at("threads"), 1);
    EXPECT_EQ(json.at("load_average").size(), 3U);
    EXPECT_EQ(json.at("l1_bytes"), stamp.l1_bytes);
    const nlohmann::ordered_json ordered = stamp;
    EXPECT_EQ(ordered.begin().key(), "version");
    EXPECT_EQ(nlohmann::json::parse(ordered.dump()), json);
}

}  // namespace
}  // namespace lancet::runtime
