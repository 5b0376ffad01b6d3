#include "lancet/experiments/common/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments {
namespace {

using Sample = std::vector<double>;

/// U by its definition: count pairs.
double pairs_greater(const Sample& a, const Sample& b) {
    double u = 0;
    for (const double x : a) {
        for (const double y : b) u += x > y ? 1.0 : (x == y ? 0.5 : 0.0);
    }
    return u;
}

/// The exact p-value by its definition: try every way to relabel the joined values.
double p_by_enumeration(const Sample& a, const Sample& b) {
    Sample all = a;
    all.insert(all.end(), b.begin(), b.end());
    const double mean = static_cast<double>(a.size() * b.size()) / 2;
    const double observed = std::abs(pairs_greater(a, b) - mean);
    std::vector<bool> chosen(all.size(), false);
    std::fill_n(chosen.begin(), a.size(), true);
    int far = 0;
    int ways = 0;
    do {
        Sample first;
        Sample second;
        for (std::size_t i = 0; i < all.size(); ++i) (chosen[i] ? first : second).push_back(all[i]);
        ++ways;
        if (std::abs(pairs_greater(first, second) - mean) >= observed) ++far;
    } while (std::prev_permutation(chosen.begin(), chosen.end()));
    return static_cast<double>(far) / ways;
}

TEST(Summary, FiveNumbersInterpolateBetweenOrderStatistics) {
    const Summary summary = summarize(Sample{7, 1, 3, 10});
    EXPECT_EQ(summary.count, 4u);
    EXPECT_DOUBLE_EQ(summary.minimum, 1);
    EXPECT_DOUBLE_EQ(summary.lower_quartile, 2.5);
    EXPECT_DOUBLE_EQ(summary.median, 5);
    EXPECT_DOUBLE_EQ(summary.upper_quartile, 7.75);
    EXPECT_DOUBLE_EQ(summary.maximum, 10);
    EXPECT_DOUBLE_EQ(summary.spread_percent(), 105);
}

TEST(Summary, OneValueIsAllOfThem) {
    const Summary summary = summarize(Sample{4});
    EXPECT_DOUBLE_EQ(summary.minimum, 4);
    EXPECT_DOUBLE_EQ(summary.median, 4);
    EXPECT_DOUBLE_EQ(summary.maximum, 4);
    EXPECT_DOUBLE_EQ(summary.spread_percent(), 0);
}

TEST(Summary, BadSamplesAreRefused) {
    EXPECT_THROW((void)summarize(Sample{}), Error);
    EXPECT_THROW((void)median(Sample{1, std::numeric_limits<double>::quiet_NaN()}), Error);
    EXPECT_THROW((void)quantile(Sample{1, 2}, 1.5), Error);
    EXPECT_THROW((void)quantile(Sample{1, 2}, std::nan("")), Error);
}

TEST(Median, OddAndEvenCounts) {
    EXPECT_DOUBLE_EQ(median(Sample{3, 1, 2}), 2);
    EXPECT_DOUBLE_EQ(median(Sample{4, 1, 2, 3}), 2.5);
}

TEST(MannWhitney, SeparatedSamples) {
    // All of `a` is below `b`: 2 of the C(8, 4) = 70 relabellings are as far out.
    const MannWhitney test = mann_whitney(Sample{1, 2, 3, 4}, Sample{5, 6, 7, 8});
    EXPECT_TRUE(test.exact);
    EXPECT_DOUBLE_EQ(test.u, 0);
    EXPECT_DOUBLE_EQ(test.p_two_sided, 2.0 / 70);
    EXPECT_DOUBLE_EQ(test.probability_greater, 0);
}

TEST(MannWhitney, ExactValuesAgreeWithEnumeration) {
    std::mt19937 generator(7);
    for (int trial = 0; trial < 40; ++trial) {
        // Few distinct values: many ties.
        std::uniform_int_distribution<int> value(0, trial % 2 == 0 ? 4 : 1000);
        Sample a(static_cast<std::size_t>(1 + trial % 5));
        Sample b(static_cast<std::size_t>(1 + trial % 6));
        for (double& x : a) x = value(generator);
        for (double& x : b) x = value(generator) + trial % 3;
        const MannWhitney test = mann_whitney(a, b);
        EXPECT_DOUBLE_EQ(test.u, pairs_greater(a, b));
        EXPECT_NEAR(test.p_two_sided, p_by_enumeration(a, b), 1e-12) << "trial " << trial;
    }
}

TEST(MannWhitney, IsSymmetric) {
    const Sample a{1.1, 2.3, 2.9, 4.4};
    const Sample b{2.0, 3.1, 5.5, 6.1, 7.0};
    const MannWhitney ab = mann_whitney(a, b);
    const MannWhitney ba = mann_whitney(b, a);
    EXPECT_DOUBLE_EQ(ab.u + ba.u, 20);
    EXPECT_DOUBLE_EQ(ab.p_two_sided, ba.p_two_sided);
}

TEST(MannWhitney, EqualValuesSayNothing) {
    EXPECT_DOUBLE_EQ(mann_whitney(Sample(5, 1.0), Sample(5, 1.0)).p_two_sided, 1);
    EXPECT_DOUBLE_EQ(mann_whitney(Sample(50, 1.0), Sample(50, 1.0)).p_two_sided, 1);
}

TEST(MannWhitney, NormalApproximationContinuesTheExactOne) {
    // 20 + 20 values are exact, 21 + 20 approximate; the p-values of nearly the same data must be near.
    Sample a;
    Sample b;
    for (int i = 0; i < 20; ++i) {
        a.push_back(i);
        b.push_back(i + 4.5);
    }
    const MannWhitney exact = mann_whitney(a, b);
    a.push_back(9.75);
    const MannWhitney approximate = mann_whitney(a, b);
    EXPECT_TRUE(exact.exact);
    EXPECT_FALSE(approximate.exact);
    EXPECT_NEAR(approximate.p_two_sided, exact.p_two_sided, 0.006);
    // By hand: u, its variance 21 * 20 * 42 / 12 without ties, and the continuity correction.
    const double distance = std::abs(pairs_greater(a, b) - 210) - 0.5;
    EXPECT_NEAR(approximate.p_two_sided, std::erfc(distance / std::sqrt(1470.0) / std::numbers::sqrt2), 1e-12);
}

TEST(MannWhitney, FalseAlarmsAreAsRareAsPromised) {
    std::mt19937 generator(3);
    std::normal_distribution<double> noise;
    constexpr int trials = 400;
    int alarms = 0;
    int found = 0;
    for (int trial = 0; trial < trials; ++trial) {
        Sample a(12);
        Sample b(12);
        for (double& x : a) x = noise(generator);
        for (double& x : b) x = noise(generator);
        if (mann_whitney(a, b).p_two_sided < 0.05) ++alarms;
        for (double& x : b) x += 2;
        if (mann_whitney(a, b).p_two_sided < 0.05) ++found;
    }
    EXPECT_LT(alarms, trials / 10);
    EXPECT_GT(found, trials * 9 / 10);
}

TEST(MannWhitney, BadSamplesAreRefused) {
    EXPECT_THROW((void)mann_whitney(Sample{}, Sample{1}), Error);
    EXPECT_THROW((void)mann_whitney(Sample{1}, Sample{}), Error);
    EXPECT_THROW((void)mann_whitney(Sample{1}, Sample{std::numeric_limits<double>::infinity()}), Error);
}

}  // namespace
}  // namespace lancet::experiments
