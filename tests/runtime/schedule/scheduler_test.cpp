#include "lancet/runtime/schedule/scheduler.hpp"

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/runtime/schedule/schedulers_under_test.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using testing::SchedulerChoice;

class SchedulerTest : public ::testing::TestWithParam<SchedulerChoice> {};
INSTANTIATE_TEST_SUITE_P(Schedulers, SchedulerTest, ::testing::ValuesIn(testing::schedulers_under_test()),
                         testing::SchedulerName());

template <class Function>
std::string error_message(const Function& function) {
    try {
        function();
    } catch (const Error& error) {
        return error.what();
    }
    return "no lancet::Error was thrown";
}

TEST_P(SchedulerTest, KnowsItsKindAndThreads) {
    const auto scheduler = GetParam().make();
    EXPECT_EQ(scheduler->kind(), GetParam().kind);
    EXPECT_EQ(scheduler->threads(), GetParam().kind == SchedulerKind::serial ? 1 : GetParam().threads);
}

TEST_P(SchedulerTest, RunsEveryBlockExactlyOnce) {
    const auto scheduler = GetParam().make();
    for (int repetition = 0; repetition < 20; ++repetition) {
        for (const int blocks : {0, 1, 2, 7, 1000}) {
            std::vector<int> plain(static_cast<std::size_t>(blocks), 0);  // a race on it is the sanitizer's to find
            std::atomic<int> calls{0};
            scheduler->for_each_block(blocks, [&](int block) {
                ++plain.at(static_cast<std::size_t>(block));
                ++calls;
            });
            EXPECT_EQ(calls, blocks);
            EXPECT_THAT(plain, Each(1)) << blocks << " blocks";
        }
    }
}

TEST_P(SchedulerTest, NeverUsesMoreThreadsThanItHas) {
    const auto scheduler = GetParam().make();
    std::atomic<int> running{0};
    std::atomic<int> most{0};
    scheduler->for_each_block(200, [&](int) {
        const int now = ++running;
        int before = most;
        while (now > before && !most.compare_exchange_weak(before, now)) {
        }
        std::this_thread::yield();
        --running;
    });
    EXPECT_LE(most, scheduler->threads());
}

TEST_P(SchedulerTest, OneBlockRunsOnTheCallingThread) {
    const auto scheduler = GetParam().make();
    std::thread::id thread;
    scheduler->for_each_block(1, [&](int) { thread = std::this_thread::get_id(); });
    EXPECT_EQ(thread, std::this_thread::get_id());
}

TEST_P(SchedulerTest, RefusesANegativeNumberOfBlocks) {
    const auto scheduler = GetParam().make();
    EXPECT_THAT(error_message([&] { scheduler->for_each_block(-3, [](int) {}); }), HasSubstr("-3 blocks"));
}

TEST_P(SchedulerTest, RethrowsTheExceptionOfTheFirstBlockThatThrows) {
    const auto scheduler = GetParam().make();
    for (int repetition = 0; repetition < 50; ++repetition) {
        std::vector<int> calls(101, 0);
        try {
            scheduler->for_each_block(101, [&](int block) {
                ++calls[static_cast<std::size_t>(block)];
                if (block % 10 == 7) throw std::runtime_error(std::to_string(block));
            });
            FAIL() << "nothing was thrown";
        } catch (const std::runtime_error& error) {
            EXPECT_STREQ(error.what(), "7");
        }
        for (std::size_t block = 0; block <= 7; ++block) EXPECT_EQ(calls[block], 1);
        EXPECT_LE(*std::max_element(calls.begin(), calls.end()), 1);
    }
    std::atomic<int> calls{0};
    scheduler->for_each_block(10, [&](int) { ++calls; });
    EXPECT_EQ(calls, 10) << "the scheduler must work after an exception";
}

TEST_P(SchedulerTest, RunsNestedLoops) {
    const auto scheduler = GetParam().make();
    constexpr int outer = 13;
    constexpr int inner = 17;
    std::vector<int> calls(outer * inner, 0);
    scheduler->for_each_block(outer, [&](int row) {
        scheduler->for_each_block(inner, [&](int column) { ++calls[static_cast<std::size_t>(row * inner + column)]; });
    });
    EXPECT_THAT(calls, Each(1));
}

TEST_P(SchedulerTest, PassesExceptionsThroughNestedLoops) {
    const auto scheduler = GetParam().make();
    try {
        scheduler->for_each_block(5, [&](int row) {
            scheduler->for_each_block(5, [&](int column) {
                if (row >= 2 && column >= 3) throw std::runtime_error(std::to_string(10 * row + column));
            });
        });
        FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "23");
    }
}

TEST_P(SchedulerTest, ServesSeveralCallersAtOnce) {
    const auto scheduler = GetParam().make();
    std::atomic<int> calls{0};
    const auto caller = [&] {
        for (int repetition = 0; repetition < 50; ++repetition) {
            scheduler->for_each_block(20, [&](int) { ++calls; });
        }
    };
    std::vector<std::thread> callers;
    for (int index = 0; index < 3; ++index) callers.emplace_back(caller);
    for (std::thread& thread : callers) thread.join();
    EXPECT_EQ(calls, 3 * 50 * 20);
}

// Two schedulers of different kinds can live and work side by side, one inside the other too.
TEST_P(SchedulerTest, WorksInsideALoopOfAnotherScheduler) {
    const auto scheduler = GetParam().make();
    for (const SchedulerKind other_kind : testing::kinds_under_test()) {
        const auto other = make_scheduler(other_kind, 2);
        std::atomic<int> calls{0};
        other->for_each_block(6, [&](int) { scheduler->for_each_block(9, [&](int) { ++calls; }); });
        EXPECT_EQ(calls, 54) << to_string(other_kind);
    }
}

TEST_P(SchedulerTest, CanBeMadeAndDestroyedManyTimes) {
    for (int repetition = 0; repetition < 20; ++repetition) {
        const auto scheduler = GetParam().make();
        std::atomic<int> calls{0};
        if (repetition % 2 == 0) scheduler->for_each_block(4, [&](int) { ++calls; });
        EXPECT_EQ(calls, repetition % 2 == 0 ? 4 : 0);
    }
}

TEST(MakeScheduler, RefusesFewerThanOneThread) {
    for (const SchedulerKind kind : available_schedulers()) {
        EXPECT_THAT(error_message([&] { make_scheduler(kind, 0); }), HasSubstr("0 threads; expected 1 or more"));
        EXPECT_THAT(error_message([&] { make_scheduler(kind, -2); }), HasSubstr(std::string(to_string(kind))));
    }
}

TEST(MakeScheduler, RefusesWhatIsNotCompiledIn) {
    const auto available = available_schedulers();
    for (const SchedulerKind kind : {SchedulerKind::openmp, SchedulerKind::tbb}) {
        if (std::count(available.begin(), available.end(), kind) > 0) continue;
        EXPECT_THAT(error_message([&] { make_scheduler(kind, 1); }), HasSubstr("is not compiled in"));
    }
}

TEST(AvailableSchedulers, HoldSerialThreadsAndTheDefault) {
    const auto kinds = available_schedulers();
    for (const SchedulerKind kind : {SchedulerKind::serial, SchedulerKind::threads, default_scheduler}) {
        EXPECT_EQ(std::count(kinds.begin(), kinds.end(), kind), 1) << to_string(kind);
    }
}

TEST(SchedulerNames, ReadBackWhatTheyPrint) {
    for (const char* text : {"serial", "openmp", "tbb", "threads"}) {
        EXPECT_EQ(to_string(scheduler_from_string(text)), text);
    }
    EXPECT_EQ(error_message([] { scheduler_from_string("TBB"); }),
              "there is no scheduler 'TBB'; expected one of: serial, openmp, tbb, threads");
}

}  // namespace
}  // namespace lancet::runtime
