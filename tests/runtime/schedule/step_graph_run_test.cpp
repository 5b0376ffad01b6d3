#include <atomic>
#include <chrono>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/runtime/schedule/schedulers_under_test.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"
#include "lancet/runtime/schedule/step_graph.hpp"

namespace lancet::runtime {
namespace {

using ::testing::Each;
using testing::SchedulerChoice;

class StepGraphRun : public ::testing::TestWithParam<SchedulerChoice> {};
INSTANTIATE_TEST_SUITE_P(Schedulers, StepGraphRun, ::testing::ValuesIn(testing::schedulers_under_test()),
                         testing::SchedulerName());

// Every task notes, in plain memory, when it started and ended; the edges must order those accesses.
TEST_P(StepGraphRun, RespectsEveryEdgeOfRandomGraphs) {
    const auto scheduler = GetParam().make();
    std::mt19937 generator(7);
    for (int trial = 0; trial < 10; ++trial) {
        constexpr std::size_t count = 40;
        StepGraph graph;
        std::vector<std::vector<std::size_t>> predecessors(count);
        std::vector<int> runs(count, 0);
        std::atomic<int> violations{0};
        std::vector<StepGraph::Task> tasks;
        for (std::size_t index = 0; index < count; ++index) {
            tasks.push_back(graph.task(std::to_string(index), [&, index] {
                for (const std::size_t earlier : predecessors[index]) {
                    if (runs[earlier] != runs[index] + 1) ++violations;
                }
                ++runs[index];
            }));
        }
        std::bernoulli_distribution edge(0.1);
        for (std::size_t later = 0; later < count; ++later) {
            for (std::size_t earlier = 0; earlier < count; ++earlier) {
                // Edges run against the numbering as often as with it, so that no order of creation hides an error.
                const bool forward = (earlier * 17) % count < (later * 17) % count;
                if (!forward || !edge(generator)) continue;
                predecessors[later].push_back(earlier);
                tasks[earlier].precede(tasks[later]);
            }
        }
        for (int repetition = 1; repetition <= 20; ++repetition) {
            graph.run(*scheduler);
            EXPECT_THAT(runs, Each(repetition));
        }
        EXPECT_EQ(violations, 0);
    }
}

TEST_P(StepGraphRun, EmptyGraphIsFine) {
    const auto scheduler = GetParam().make();
    StepGraph graph;
    graph.run(*scheduler);
    graph.run(*scheduler);
    EXPECT_EQ(graph.size(), 0);
}

TEST_P(StepGraphRun, CanGrowBetweenRunsAndChangeItsScheduler) {
    StepGraph graph;
    std::atomic<int> calls{0};
    auto last = graph.task("0", [&] { ++calls; });
    int expected = 0;
    for (int round = 1; round <= 5; ++round) {
        const auto scheduler = GetParam().make();  // often at the address of the one before
        graph.run(*scheduler);
        expected += round;
        auto next = graph.task(std::to_string(round), [&] { ++calls; });
        last.precede(next);
        last = next;
    }
    EXPECT_EQ(calls, expected);
}

TEST_P(StepGraphRun, LoopsInsideTasksRunEveryBlockOnce) {
    const auto scheduler = GetParam().make();
    constexpr std::size_t count = 12;
    constexpr int blocks = 23;
    std::vector<std::vector<int>> calls(count, std::vector<int>(blocks, 0));
    StepGraph graph;
    auto first = graph.task("first", [] {});
    auto last = graph.task("last", [] {});
    for (std::size_t index = 0; index < count; ++index) {
        auto middle = graph.task("middle " + std::to_string(index), [&, index] {
            for (int repetition = 0; repetition < 5; ++repetition) {
                scheduler->for_each_block(blocks, [&](int block) { ++calls[index][static_cast<std::size_t>(block)]; });
            }
        });
        first.precede(middle);
        middle.precede(last);
    }
    for (int repetition = 1; repetition <= 10; ++repetition) {
        graph.run(*scheduler);
        for (const auto& task_calls : calls) EXPECT_THAT(task_calls, Each(5 * repetition));
    }
}

// A thread that waits for the blocks of its own loop must not start another task of the graph meanwhile. Many short
// tasks are ready while the loops run, and a helper that takes part of a loop lets the loop's owner wait.
TEST_P(StepGraphRun, WaitingThreadTakesUpNoOtherTask) {
    const auto scheduler = GetParam().make();
    static thread_local bool in_a_task = false;
    std::atomic<int> mixed{0};
    const auto enter = [&] {
        if (in_a_task) ++mixed;
        in_a_task = true;
    };
    StepGraph graph;
    auto root = graph.task("root", [] {});
    const auto pause = [](int microseconds) { std::this_thread::sleep_for(std::chrono::microseconds(microseconds)); };
    for (int index = 0; index < 200; ++index) {
        const bool loops = index % 50 == 25;
        root.precede(graph.task("task " + std::to_string(index), [&, loops] {
            enter();
            if (loops) {
                for (int repetition = 0; repetition < 20; ++repetition) {
                    scheduler->for_each_block(8, [&](int block) { pause(block >= 4 ? 100 : 10); });
                }
            } else {
                pause(20);
            }
            in_a_task = false;
        }));
    }
    for (int repetition = 0; repetition < 2; ++repetition) graph.run(*scheduler);
    EXPECT_EQ(mixed, 0);
}

// While one task runs loop after loop, another one that is ready gets a thread.
TEST_P(StepGraphRun, IndependentTasksOverlap) {
    const auto scheduler = GetParam().make();
    if (scheduler->threads() == 1) GTEST_SKIP() << "one thread runs one task at a time";
    constexpr int patience = 1'000'000;  // a minute and more: only a scheduler that never overlaps gets there
    std::atomic<bool> one_started{false};
    std::atomic<bool> other_started{false};
    std::atomic<int> met{0};
    const auto meet = [&](std::atomic<bool>& mine, const std::atomic<bool>& other) {
        mine = true;
        for (int look = 0; look < patience && !other; ++look)
            std::this_thread::sleep_for(std::chrono::microseconds(50));
        if (other) ++met;
    };
    StepGraph graph;
    graph.task("one", [&] { meet(one_started, other_started); });
    graph.task("other", [&] { meet(other_started, one_started); });
    graph.run(*scheduler);
    EXPECT_EQ(met, 2);
}

TEST_P(StepGraphRun, RethrowsWhatATaskThrowsAndCanRunAgain) {
    const auto scheduler = GetParam().make();
    bool fail = true;
    int later_runs = 0;
    StepGraph graph;
    auto solve = graph.task("solve", [&] {
        scheduler->for_each_block(9, [&](int block) {
            if (fail && block >= 4) throw std::runtime_error("block " + std::to_string(block));
        });
    });
    solve.precede(graph.task("later", [&] { ++later_runs; }));
    for (int repetition = 0; repetition < 20; ++repetition) {
        fail = true;
        try {
            graph.run(*scheduler);
            FAIL() << "nothing was thrown";
        } catch (const std::runtime_error& error) {
            EXPECT_STREQ(error.what(), "block 4");
        }
        EXPECT_EQ(later_runs, repetition);
        fail = false;
        graph.run(*scheduler);
        EXPECT_EQ(later_runs, repetition + 1);
    }
}

TEST_P(StepGraphRun, GraphInsideATaskRuns) {
    const auto scheduler = GetParam().make();
    std::vector<int> calls(4, 0);
    std::vector<StepGraph> inner(2);
    for (std::size_t which = 0; which < 2; ++which) {
        auto a = inner[which].task("a", [&, which] { ++calls[2 * which]; });
        auto b =
            inner[which].task("b", [&, which] { scheduler->for_each_block(3, [](int) {}), ++calls[2 * which + 1]; });
        a.precede(b);
    }
    StepGraph outer;
    outer.task("one", [&] { inner[0].run(*scheduler); });
    outer.task("other", [&] { inner[1].run(*scheduler); });
    for (int repetition = 1; repetition <= 10; ++repetition) {
        outer.run(*scheduler);
        EXPECT_THAT(calls, Each(repetition));
    }
}

TEST_P(StepGraphRun, SeveralThreadsMayRunTheirGraphsOnOneScheduler) {
    const auto scheduler = GetParam().make();
    std::atomic<int> calls{0};
    const auto caller = [&] {
        StepGraph graph;
        auto a = graph.task("a", [&] { scheduler->for_each_block(4, [&](int) { ++calls; }); });
        auto b = graph.task("b", [&] { scheduler->for_each_block(4, [&](int) { ++calls; }); });
        auto c = graph.task("c", [&] { ++calls; });
        a.precede(c);
        b.precede(c);
        for (int repetition = 0; repetition < 20; ++repetition) graph.run(*scheduler);
    };
    std::vector<std::thread> callers;
    for (int index = 0; index < 3; ++index) callers.emplace_back(caller);
    for (std::thread& thread : callers) thread.join();
    EXPECT_EQ(calls, 3 * 20 * 9);
}

TEST_P(StepGraphRun, RefusesToRunTwiceAtOnceToChangeWhileRunningAndToRunInALoopBody) {
    const auto scheduler = GetParam().make();
    StepGraph graph;
    bool in_task = false;
    bool in_change = false;
    graph.task("a", [&] {
        try {
            graph.run(*scheduler);
        } catch (const Error&) {
            in_task = true;
        }
        try {
            graph.task("b", [] {});
        } catch (const Error&) {
            in_change = true;
        }
    });
    graph.run(*scheduler);
    EXPECT_TRUE(in_task);
    EXPECT_TRUE(in_change);
    EXPECT_THROW(scheduler->for_each_block(2, [&](int) { graph.run(*scheduler); }), Error);
}

}  // namespace
}  // namespace lancet::runtime
