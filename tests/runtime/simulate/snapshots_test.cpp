#include "lancet/runtime/simulate/snapshots.hpp"

#include <array>
#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "lancet/runtime/simulate/rate.hpp"
#include "lancet/runtime/simulate/sample_queue.hpp"

namespace lancet::runtime {
namespace {

TEST(Snapshots, ReadersKeepWhatTheyHold) {
    Snapshots<int, 3> snapshots;
    EXPECT_FALSE(snapshots.latest());
    const auto publish = [&](int value) {
        int* slot = snapshots.begin();
        if (slot == nullptr) return false;
        *slot = value;
        snapshots.publish();
        return true;
    };
    EXPECT_TRUE(publish(1));
    const auto first = snapshots.latest();
    EXPECT_TRUE(publish(2));
    {
        const auto second = snapshots.latest();
        EXPECT_TRUE(publish(3));
        const auto third = snapshots.latest();
        EXPECT_FALSE(publish(4)) << "all other slots are being read";
        EXPECT_EQ(*first, 1);
        EXPECT_EQ(*second, 2);
        EXPECT_EQ(*third, 3);
    }
    EXPECT_TRUE(publish(5));
    EXPECT_EQ(*snapshots.latest(), 5);
    EXPECT_EQ(*first, 1);
}

TEST(Snapshots, AreWholeAndNeverGoBack) {
    Snapshots<std::array<long, 64>> snapshots;
    std::atomic<bool> ends{false};
    std::vector<std::thread> readers;
    for (int k = 0; k < 3; ++k) {
        readers.emplace_back([&] {
            long last = 0;
            while (!ends) {
                const auto latest = snapshots.latest();
                if (!latest) continue;
                for (const long value : *latest) ASSERT_EQ(value, latest->front());
                ASSERT_GE(latest->front(), last);
                last = latest->front();
            }
        });
    }
    for (long value = 1; value <= 20000; ++value) {
        auto* slot = snapshots.begin();
        ASSERT_NE(slot, nullptr) << "three readers leave room in five slots";
        slot->fill(value);
        snapshots.publish();
    }
    ends = true;
    for (std::thread& reader : readers) reader.join();
}

TEST(SampleQueue, KeepsOrderBetweenTwoThreads) {
    SampleQueue queue;
    constexpr int count = 50000;
    std::thread device([&] {
        for (int k = 0; k < count;) {
            if (queue.push({.time = static_cast<double>(k)})) ++k;
        }
    });
    for (int k = 0; k < count;) {
        ToolSample sample;
        if (!queue.pop(sample)) continue;
        ASSERT_EQ(sample.time, k);
        ++k;
    }
    device.join();
    ToolSample sample;
    EXPECT_FALSE(queue.pop(sample));
}

TEST(Rate, IsDueOnTimeWhateverTheStep) {
    Rate rate(30);
    int due = 0;
    for (int step = 0; step < 25 * 60; ++step) due += rate.due(step * 0.04) ? 1 : 0;
    EXPECT_EQ(due, 25 * 60) << "faster than the steps: each";
    Rate slow(30);
    due = 0;
    for (int step = 0; step < 200 * 60; ++step) due += slow.due(step * 0.005) ? 1 : 0;
    EXPECT_EQ(due, 30 * 60);
    Rate never;
    EXPECT_FALSE(never.due(1));
    EXPECT_FALSE(never.ever());
}

}  // namespace
}  // namespace lancet::runtime
