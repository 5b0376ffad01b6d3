#include "lancet/runtime/schedule/ordered_sum.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "tests/runtime/schedule/schedulers_under_test.hpp"
#include <gtest/gtest.h>

namespace lancet::runtime {
namespace {

// Magnitudes from 1e-20 to 1e+20 with both signs, and large values that cancel in other blocks: any other order of
// addition gives other bits.
std::vector<double> adversarial_values(std::size_t count) {
    std::mt19937_64 generator(20240229);
    std::uniform_real_distribution<double> exponent(-20, 20);
    std::uniform_real_distribution<double> mantissa(-1, 1);
    std::vector<double> values(count);
    for (std::size_t index = 0; index < count / 2; ++index) {
        values[index] = mantissa(generator) * std::pow(10.0, exponent(generator));
        values[count - 1 - index] = -values[index] * (1 + 1e-15 * mantissa(generator));
    }
    return values;
}

constexpr std::size_t block_size = 64;
constexpr std::size_t block_count = 128;

TEST(OrderedSum, HasTheSameBitsOnEverySchedulerAndThreadCount) {
    const auto values = adversarial_values(block_size * block_count);
    const auto partial = [&](int block) {
        double sum = 0;
        for (std::size_t index = 0; index < block_size; ++index) {
            sum += values[static_cast<std::size_t>(block) * block_size + index];
        }
        return sum;
    };
    std::vector<double> partials(block_count);
    double expected = 0;
    double backwards = 0;
    for (int block = 0; block < static_cast<int>(block_count); ++block) expected += partial(block);
    for (int block = static_cast<int>(block_count); block-- > 0;) backwards += partial(block);
    ASSERT_NE(expected, backwards) << "the values do not tell one order from another";

    for (const auto& choice : testing::schedulers_under_test()) {
        const auto scheduler = choice.make();
        for (int repetition = 0; repetition < 200; ++repetition) {
            std::fill(partials.begin(), partials.end(), 1e300);
            const double sum = ordered_sum(*scheduler, std::span<double>(partials), partial);
            ASSERT_EQ(std::bit_cast<std::uint64_t>(sum), std::bit_cast<std::uint64_t>(expected)) << choice;
        }
    }
}

TEST(OrderedSum, AddsSeveralQuantitiesInOnePass) {
    std::vector<Sums<3>> partials(10);
    for (const auto& choice : testing::schedulers_under_test()) {
        const auto scheduler = choice.make();
        const auto sums = ordered_sum(*scheduler, std::span<Sums<3>>(partials), [](int block) {
            return Sums<3>{{1.0, static_cast<double>(block), static_cast<double>(block * block)}};
        });
        EXPECT_EQ(sums, (Sums<3>{{10.0, 45.0, 285.0}})) << choice;
        EXPECT_EQ(partials[4][2], 16.0);
    }
}

TEST(OrderedSum, OfNothingIsZero) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    EXPECT_EQ(ordered_sum(*scheduler, std::span<double>(), [](int) { return 1.0; }), 0.0);
    EXPECT_EQ(sum_in_order(std::span<const Sums<2>>()), Sums<2>{});
}

}  // namespace
}  // namespace lancet::runtime
