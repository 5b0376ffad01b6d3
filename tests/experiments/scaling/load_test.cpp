#include "lancet/experiments/scaling/load.hpp"

#include <atomic>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/runtime/observe/clock.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::experiments::scaling {
namespace {

TEST(LoadRule, ALostShareIsWhatWasWaitedAndStolenOrWhatASpinTookLonger) {
    const Load load{.waited = 0.1, .stolen = 0.05, .others = 0.8, .spin_seconds = 0.002};
    EXPECT_DOUBLE_EQ(lost_share(load, 0.002, false, 2), 0.1 + 0.05);
    EXPECT_DOUBLE_EQ(lost_share(load, 0.001, false, 2), 0.5);
    // Threads that wait for each other: only what others had counts.
    EXPECT_DOUBLE_EQ(lost_share(load, 0.001, true, 2), 0.4 + 0.05);
    EXPECT_DOUBLE_EQ(lost_share({.spin_seconds = 0.001}, 0.001, false, 2), 0.0);
    EXPECT_DOUBLE_EQ(lost_share({}, 0.0, false, 2), 0.0) << "without counters";
}

TEST(LoadRule, MarksRows) {
    const auto mark = [](const std::vector<double>& lost, int repetitions) {
        return judge(lost, enough_quiet(repetitions));
    };
    EXPECT_EQ(mark({0.0}, 1), LoadMark::quiet);
    EXPECT_EQ(mark({0.049, 0.9, 0.01}, 3), LoadMark::quiet);
    EXPECT_EQ(mark({0.9, 0.01}, 2), LoadMark::quiet);  // half of them
    EXPECT_EQ(mark({0.051, 0.9, 0.01}, 3), LoadMark::loaded);
    EXPECT_EQ(mark({0.06, 0.1, 0.2}, 3), LoadMark::loaded);
    EXPECT_EQ(mark({0.24, 0.06, 0.9}, 3), LoadMark::loaded);
    EXPECT_EQ(mark({0.25}, 1), LoadMark::meaningless);
    EXPECT_EQ(mark({0.3, 0.0, 0.26}, 3), LoadMark::meaningless);
    // Further rounds count like the first ones, and what is enough stays the same.
    EXPECT_EQ(mark({0.3, 0.0, 0.26, 0.9, 0.02}, 3), LoadMark::quiet);
}

TEST(LoadRule, QuietRowsCountTheirQuietRepetitionsAlone) {
    EXPECT_TRUE(counts(LoadMark::quiet, 0.049));
    EXPECT_FALSE(counts(LoadMark::quiet, 0.05));
    EXPECT_TRUE(counts(LoadMark::loaded, 0.9));
    EXPECT_TRUE(counts(LoadMark::meaningless, 0.9));
    EXPECT_EQ(to_string(LoadMark::quiet), "");
    EXPECT_EQ(to_string(LoadMark::loaded), "loaded");
    EXPECT_EQ(to_string(LoadMark::meaningless), "meaningless");
    EXPECT_THAT(describe_load_rule(), testing::AllOf(testing::HasSubstr("5.00 %"), testing::HasSubstr("25.0 %")));
}

TEST(CoreTimes, AreReadFromTheFirstLine) {
    const auto times = core_times("cpu  100 20 30 4000 5 6 7 80 0 0\ncpu0 1 1 1 1 1 1 1 1 0 0\n", 100);
    ASSERT_TRUE(times);
    EXPECT_DOUBLE_EQ(times->busy, (100 + 20 + 30 + 6 + 7) / 100.0);
    EXPECT_DOUBLE_EQ(times->stolen, 0.8);
    EXPECT_FALSE(core_times("", 100));
    EXPECT_FALSE(core_times("intr 1 2 3 4 5 6 7 8", 100));
    EXPECT_FALSE(core_times("cpu 1 2 3", 100));
}

// A thread of the same process that keeps a core busy is no other process, and what is measured is within its bounds.
TEST(LoadMeter, MeasuresSharesOfThisProcess) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    LoadMeter meter;
    meter.begin(*scheduler);
    const double start = runtime::steady_seconds();
    while (runtime::steady_seconds() - start < 0.2) {
    }
    meter.end(*scheduler);
    const Load load = meter.finish();
    EXPECT_GT(load.spin_seconds, 1e-5);
    EXPECT_GE(load.waited, 0);
    EXPECT_LE(load.waited, 1);
    EXPECT_GE(load.stolen, 0);
    EXPECT_LE(load.stolen, 1);
    EXPECT_GE(load.others, 0);
    // Ticks of a hundredth of a second on each core, at both ends of at least 0.2 s.
    const double cores = std::thread::hardware_concurrency();
    EXPECT_LE(load.others, cores + 0.1 * cores);
}

}  // namespace
}  // namespace lancet::experiments::scaling
