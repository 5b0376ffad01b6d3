// Helpers that stay from loop to loop: every block runs once whoever comes, leaves, or is late.
#include "lancet/runtime/schedule/loop_crew.hpp"

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace lancet::test {
namespace {

using runtime::ChunkedLoop;
using runtime::LoopCrew;

/// Threads that serve whenever they are called.
class Callers {
  public:
    Callers(LoopCrew& crew, int threads) : crew_(crew) {
        for (int k = 0; k < threads; ++k) {
            threads_.emplace_back([this] {
                while (!ends_) {
                    int calls = calls_.load();
                    if (calls > 0 && calls_.compare_exchange_strong(calls, calls - 1)) crew_.serve();
                    std::this_thread::yield();
                }
            });
        }
    }
    ~Callers() {
        crew_.dismiss();
        ends_ = true;
        for (std::thread& thread : threads_) thread.join();
        while (calls_-- > 0) crew_.serve();
    }
    void call() { ++calls_; }

  private:
    LoopCrew& crew_;
    std::atomic<int> calls_{0};
    std::atomic<bool> ends_{false};
    std::vector<std::thread> threads_;
};

TEST(LoopCrew, RunsEveryBlockOfEveryLoopOnce) {
    for (const int threads : {2, 3}) {
        LoopCrew crew(threads);
        Callers callers(crew, threads - 1);
        for (int round = 0; round < 3000; ++round) {
            const int blocks = 1 + round % 7;
            std::vector<int> runs(static_cast<std::size_t>(blocks));  // written without locks: chunks do not share
            const auto body = [&](int block) { ++runs[static_cast<std::size_t>(block)]; };
            ChunkedLoop loop(&crew, blocks, threads, body);
            const LoopCrew::Lease lease(crew);
            ASSERT_TRUE(lease.is_granted());
            crew.run(loop, [&] { callers.call(); });
            for (const int count : runs) ASSERT_EQ(count, 1) << "loop " << round;
            // Helpers are sent away and called again, sometimes.
            if (round % 50 == 0) crew.send_home();
            if (round % 70 == 0) crew.count_ready(1);
            if (round % 70 == 5) crew.count_ready(-1);
        }
    }
}

TEST(LoopCrew, WaitsForNobodyWhoDoesNotCome) {
    LoopCrew crew(4);
    int calls = 0;
    for (int round = 0; round < 10; ++round) {
        std::vector<std::thread::id> ran_on(9);
        const auto body = [&](int block) { ran_on[static_cast<std::size_t>(block)] = std::this_thread::get_id(); };
        ChunkedLoop loop(&crew, 9, 4, body);
        crew.run(loop, [&] { ++calls; });
        for (const std::thread::id& id : ran_on) EXPECT_EQ(id, std::this_thread::get_id());
    }
    EXPECT_EQ(calls, 3);  // each helper is called once, and has not come yet
}

TEST(LoopCrew, ThrowsWhatABlockThrowsAndGoesOn) {
    LoopCrew crew(2);
    Callers callers(crew, 1);
    for (int round = 0; round < 200; ++round) {
        const auto body = [&](int block) {
            if (block == 3) throw std::runtime_error("3");
        };
        ChunkedLoop loop(&crew, 8, 2, body);
        crew.run(loop, [&] { callers.call(); });
        EXPECT_THROW(loop.rethrow(), std::runtime_error);
    }
}

TEST(LoopCrew, LeavesTheThreadThatRunsLoopsAlone) {
    LoopCrew crew(2);
    const auto body = [](int) {};
    ChunkedLoop loop(&crew, 2, 2, body);
    crew.run(loop, [] {});
    crew.serve();  // returns at once: nothing else would run loops
    int calls = 0;
    crew.run(loop, [&] { ++calls; });
    EXPECT_EQ(calls, 1);  // it is known to have left
}

TEST(LoopCrew, IsLeasedOnce) {
    LoopCrew crew(2);
    {
        const LoopCrew::Lease first(crew);
        EXPECT_TRUE(first.is_granted());
        const LoopCrew::Lease second(crew);
        EXPECT_FALSE(second.is_granted());
    }
    const LoopCrew::Lease third(crew);
    EXPECT_TRUE(third.is_granted());
}

}  // namespace
}  // namespace lancet::test
