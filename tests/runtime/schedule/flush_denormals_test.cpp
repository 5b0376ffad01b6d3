#include "lancet/runtime/schedule/flush_denormals.hpp"

#include <array>
#include <atomic>
#include <limits>
#include <mutex>
#include <set>
#include <thread>

#include "tests/runtime/schedule/schedulers_under_test.hpp"
#include <gtest/gtest.h>

#include "lancet/runtime/schedule/step_graph.hpp"

namespace lancet::runtime {
namespace {

using testing::SchedulerChoice;

// What the arithmetic itself does; volatile keeps the compiler from computing it beforehand.
bool results_are_flushed() {
    volatile double smallest_normal = std::numeric_limits<double>::min();
    return smallest_normal * 0.5 == 0.0;
}

bool operands_are_flushed() {
    volatile float denormal = std::numeric_limits<float>::denorm_min();
    volatile float huge = 1e30F;
    return denormal * huge == 0.0F;
}

bool denormals_are_flushed() {
    return FlushDenormals::active() && results_are_flushed() && operands_are_flushed();
}
bool denormals_are_kept() {
    return !FlushDenormals::active() && !results_are_flushed() && !operands_are_flushed();
}

TEST(FlushDenormals, SetsTheModeAndRestoresIt) {
    ASSERT_TRUE(denormals_are_kept());
    {
        const FlushDenormals outer;
        EXPECT_TRUE(denormals_are_flushed());
        {
            const FlushDenormals inner;
            EXPECT_TRUE(denormals_are_flushed());
        }
        EXPECT_TRUE(denormals_are_flushed());
    }
    EXPECT_TRUE(denormals_are_kept());
}

class FlushDenormalsOn : public ::testing::TestWithParam<SchedulerChoice> {};
INSTANTIATE_TEST_SUITE_P(Schedulers, FlushDenormalsOn, ::testing::ValuesIn(testing::schedulers_under_test()),
                         testing::SchedulerName());

// Blocks wait for each other a little, so that the threads share them, and loops repeat until every thread was seen (or
// for so long that the machine must have other things to do; two threads must have been seen then).
TEST_P(FlushDenormalsOn, EveryThreadThatRunsABlock) {
    const auto scheduler = GetParam().make();
    std::mutex mutex;
    std::set<std::thread::id> seen;
    std::atomic<int> wrong{0};
    std::atomic<int> arrived{0};
    for (int repetition = 0; repetition < 5000 && static_cast<int>(seen.size()) < scheduler->threads(); ++repetition) {
        arrived = 0;
        scheduler->for_each_block(scheduler->threads(), [&](int) {
            if (!denormals_are_flushed()) ++wrong;
            ++arrived;
            for (int wait = 0; wait < 200 && arrived < scheduler->threads(); ++wait) std::this_thread::yield();
            const std::scoped_lock lock(mutex);
            seen.insert(std::this_thread::get_id());
        });
    }
    EXPECT_EQ(wrong, 0);
    EXPECT_TRUE(denormals_are_kept()) << "the caller's mode must be as before";
    RecordProperty("threads_seen", static_cast<int>(seen.size()));
    if (scheduler->threads() > 1) {
        EXPECT_GT(seen.size(), 1U);
    }
}

TEST_P(FlushDenormalsOn, GraphTasksAndTheirLoops) {
    const auto scheduler = GetParam().make();
    std::atomic<int> wrong{0};
    StepGraph graph;
    auto first = graph.task("first", [&] {
        if (!denormals_are_flushed()) ++wrong;
    });
    for (int index = 0; index < 8; ++index) {
        first.precede(graph.task("loop " + std::to_string(index), [&] {
            if (!denormals_are_flushed()) ++wrong;
            scheduler->for_each_block(16, [&](int) {
                if (!denormals_are_flushed()) ++wrong;
            });
            if (!denormals_are_flushed()) ++wrong;
        }));
    }
    graph.run(*scheduler);
    EXPECT_EQ(wrong, 0);
    EXPECT_TRUE(denormals_are_kept());
}

TEST_P(FlushDenormalsOn, CallersModeIsRestoredAfterAnException) {
    const auto scheduler = GetParam().make();
    EXPECT_THROW(scheduler->for_each_block(16, [](int) { throw 1; }), int);
    EXPECT_TRUE(denormals_are_kept());
}

}  // namespace
}  // namespace lancet::runtime
