#include "lancet/runtime/observe/bandwidth.hpp"

#include <cstddef>
#include <numeric>
#include <vector>

#include "tests/runtime/schedule/schedulers_under_test.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/observe/stream_loops.hpp"

namespace lancet::runtime {
namespace {

TEST(StreamLoops, ComputeWhatTheySayForEverySizeAndAlignment) {
    for (std::size_t size = 0; size < 200; ++size) {
        for (std::size_t offset = 0; offset < 4; ++offset) {
            std::vector<double> b(size + offset);
            std::iota(b.begin(), b.end(), 1.0);
            const auto values = std::span<const double>(b).subspan(offset);
            EXPECT_EQ(stream_sum(values), std::accumulate(values.begin(), values.end(), 0.0));
            std::vector<double> result(size, -1.0);
            stream_triad(result, values, values, 2.0);
            for (std::size_t index = 0; index < size; ++index) ASSERT_EQ(result[index], 3.0 * values[index]);
        }
    }
}

// Loops that the compiler had removed would show impossible speeds: a core moves at most some hundred bytes a cycle.
TEST(MeasureBandwidth, GivesPossibleSpeedsOnEveryScheduler) {
    for (const SchedulerKind kind : testing::kinds_under_test()) {
        for (const int threads : {1, 2}) {
            const auto scheduler = make_scheduler(kind, threads);
            for (const std::size_t bytes : {std::size_t{4096}, std::size_t{1'000'000}}) {
                const Bandwidth bandwidth = measure_bandwidth(*scheduler, bytes, 3);
                const double most = 1000.0 * scheduler->threads();
                EXPECT_GT(bandwidth.read_gbytes_per_s, 0.0);
                EXPECT_LT(bandwidth.read_gbytes_per_s, most);
                EXPECT_GT(bandwidth.triad_gbytes_per_s, 0.0);
                EXPECT_LT(bandwidth.triad_gbytes_per_s, most);
            }
        }
    }
}

TEST(MeasureBandwidth, RefusesATooSmallWorkingSetAndNoRepetitions) {
    const auto scheduler = make_scheduler(SchedulerKind::threads, 3);
    EXPECT_THROW(measure_bandwidth(*scheduler, 3071), Error);
    EXPECT_NO_THROW(measure_bandwidth(*scheduler, 3072, 1));
    EXPECT_THROW(measure_bandwidth(*scheduler, 1'000'000, 0), Error);
}

}  // namespace
}  // namespace lancet::runtime
