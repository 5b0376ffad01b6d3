#include "lancet/runtime/observe/clock.hpp"

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

namespace lancet::runtime {
namespace {

TEST(SteadySeconds, CountSeconds) {
    const double start = steady_seconds();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_GE(steady_seconds() - start, 0.02);
}

TEST(SteadySeconds, NeverGoBack) {
    double before = steady_seconds();
    for (int look = 0; look < 10000; ++look) {
        const double now = steady_seconds();
        ASSERT_GE(now, before);
        before = now;
    }
}

}  // namespace
}  // namespace lancet::runtime
