#include "lancet/runtime/observe/trace.hpp"

#include <map>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {
namespace {

TEST(Trace, TellsTasksByStartInMicroseconds) {
    Trace trace(8);
    trace.ended(1, "solve", 10.002, 10.005);
    trace.ended(0, "forces", 10.0, 10.001);
    const auto document = nlohmann::json::parse(trace.json());
    const auto& events = document.at("traceEvents");
    ASSERT_EQ(events.size(), 2U);
    EXPECT_EQ(events[0].at("name"), "forces");
    EXPECT_EQ(events[0].at("ph"), "X");
    EXPECT_EQ(events[0].at("ts"), 0);
    EXPECT_NEAR(events[1].at("ts").get<double>(), 2000, 1e-6);
    EXPECT_NEAR(events[1].at("dur").get<double>(), 3000, 1e-6);
    EXPECT_EQ(events[0].at("tid"), events[1].at("tid"));
}

TEST(Trace, CountsWhatHasNoPlace) {
    Trace trace(2);
    for (int k = 0; k < 5; ++k) trace.ended(0, "task", k, k + 1);
    EXPECT_EQ(trace.recorded(), 2U);
    EXPECT_EQ(trace.lost(), 3U);
    EXPECT_THROW(Trace(0), Error);
}

TEST(Trace, TakesTasksOfManyThreads) {
    Trace trace(4000);
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&trace, t] {
            for (int k = 0; k < 1000; ++k) trace.ended(t, "task", k, k + 0.5);
        });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(trace.recorded(), 4000U);
    EXPECT_EQ(trace.lost(), 0U);
    const auto document = nlohmann::json::parse(trace.json());
    std::map<int, int> of_thread;
    for (const auto& event : document.at("traceEvents")) ++of_thread[event.at("tid").get<int>()];
    EXPECT_EQ(of_thread.size(), 4U);
    for (const auto& [thread, count] : of_thread) EXPECT_EQ(count, 1000);
}

TEST(Trace, AFileThatCannotBeWrittenIsAnError) {
    const Trace trace(1);
    EXPECT_THROW(trace.write("/no/such/folder/trace.json"), Error);
}

}  // namespace
}  // namespace lancet::runtime
