// Signs of nearly cancelling sums: what bounded numbers call certain is what integers say.
#include "lancet/mesh/cut/numbers.hpp"

#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace lancet::test {
namespace {

using mesh::Bounded;
using mesh::Exact;
using mesh::Extended;

/// |a - b| <= bound, exactly.
bool is_within(const Exact& a, const Exact& b, double bound) {
    return (a - b - Exact(bound)).sign() <= 0 && (b - a - Exact(bound)).sign() <= 0;
}

Exact value(const Extended& number) {
    return Exact(number.high) + Exact(number.low);
}

TEST(Extended, BoundsHoldForDeterminantsThatNearlyVanish) {
    std::mt19937 generator(2026);
    std::uniform_real_distribution<double> uniform(-1, 1);
    int certain = 0, undecided_in_one = 0;
    for (int round = 0; round < 2000; ++round) {
        const double away = std::ldexp(1, -(round % 60));
        std::array<std::array<double, 4>, 4> rows{};
        for (auto& row : rows) {
            for (double& entry : row) entry = std::ldexp(uniform(generator), round % 7 * 10 - 30);
        }
        // The last row is nearly a combination of the others.
        for (std::size_t k = 0; k < 4; ++k) {
            rows[3][k] = 0.75 * rows[0][k] - 0.3 * rows[1][k] + 1.9 * rows[2][k] + away * rows[3][k];
        }
        std::array<std::array<Bounded, 4>, 4> bounded{};
        std::array<std::array<Extended, 4>, 4> extended{};
        std::array<std::array<Exact, 4>, 4> exact{};
        for (std::size_t row = 0; row < 4; ++row) {
            for (std::size_t k = 0; k < 4; ++k) {
                bounded[row][k] = {rows[row][k], 0};
                extended[row][k] = {rows[row][k], 0, 0};
                exact[row][k] = Exact(rows[row][k]);
            }
        }
        const Bounded in_one = dot(bounded[3], cross(bounded[0], bounded[1], bounded[2]));
        const Extended in_two = dot(extended[3], cross(extended[0], extended[1], extended[2]));
        const Exact in_all = dot(exact[3], cross(exact[0], exact[1], exact[2]));
        EXPECT_TRUE(is_within(Exact(in_one.value), in_all, in_one.error)) << "round " << round;
        EXPECT_TRUE(is_within(value(in_two), in_all, in_two.error)) << "round " << round;
        EXPECT_TRUE(is_within(Exact(in_two.bounded().value), in_all, in_two.bounded().error)) << "round " << round;
        if (in_one.is_certain()) {
            EXPECT_EQ(in_one.sign(), in_all.sign());
        } else {
            ++undecided_in_one;
        }
        if (!in_two.is_certain()) continue;
        ++certain;
        EXPECT_EQ(in_two.sign(), in_all.sign());
    }
    EXPECT_GT(undecided_in_one, 100);
    EXPECT_GT(certain, 1900);
}

TEST(Extended, TakesExactNumbersAndDifferences) {
    const Exact third = (Exact(1) + Exact(0x1p-80)) * (Exact(1) + Exact(0x1p-70)) * Exact(-3);
    EXPECT_TRUE(is_within(value(third.extended()), third, third.extended().error));
    EXPECT_LT(third.extended().error, 0x1p-98);
    const Extended difference = Extended::difference(1, 0x1.fffffffffffffp-60);
    EXPECT_EQ(difference.error, 0);
    EXPECT_EQ((value(difference) - (Exact(1) - Exact(0x1.fffffffffffffp-60))).sign(), 0);
}

TEST(Extended, IsNeverCertainOutsideOfTheRangeOfDouble) {
    const Extended huge{1e300, 0, 0}, tiny{1e-200, 0, 0};
    EXPECT_FALSE((huge * huge).is_certain());
    EXPECT_FALSE((huge * huge).is_precise(0.5));
    EXPECT_FALSE((tiny * tiny).is_certain());
    EXPECT_FALSE(Extended::difference(1.5e308, -1.5e308).is_certain());
    EXPECT_TRUE((tiny * Extended{}).is_certain());  // a zero is one
}

}  // namespace
}  // namespace lancet::test
