#include "lancet/experiments/scaling/amdahl.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::scaling {
namespace {

double law(double serial, double time, int threads) {
    return time * (serial + (1 - serial) / threads);
}

std::vector<ThreadTime> times_of(double serial, double time, const std::vector<int>& counts) {
    std::vector<ThreadTime> times;
    for (const int threads : counts) times.push_back({threads, law(serial, time, threads)});
    return times;
}

// Times that follow the law give its numbers back; the system is solved by Cramer's rule with a condition below 1e3, so
// ten digits are left.
TEST(Amdahl, FindsTheLawThatMadeTheTimes) {
    for (const double serial : {-0.05, 0.0, 0.02, 0.3, 1.0}) {
        const auto fit = fit_amdahl(times_of(serial, 7.5, {1, 2, 4, 8}));
        ASSERT_TRUE(fit);
        EXPECT_NEAR(fit->serial_fraction, serial, 1e-10);
        EXPECT_NEAR(fit->time_on_one_thread, 7.5, 1e-9);
        EXPECT_NEAR(fit->standard_error, 0, 1e-7);  // the square root of a sum of squares that is rounding alone
        if (serial > 0) {
            EXPECT_NEAR(fit->highest_speedup().value(), 1 / serial, 1e-8 / (serial * serial));
        } else if (serial < 0) {
            EXPECT_FALSE(fit->highest_speedup());
        }
    }
}

// A speed-up of 6.5 on 8 cores is a serial part of (8 / 6.5 - 1) / 7 = 3.3 %.
TEST(Amdahl, TheOriginalsSpeedUp) {
    const double serial = (8 / 6.5 - 1) / 7;
    const auto fit = fit_amdahl(times_of(serial, 36.4, {1, 2, 3, 4, 5, 6, 7, 8}));
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->serial_fraction, 0.03297, 1e-5);
    EXPECT_NEAR(36.4 / law(fit->serial_fraction, 36.4, 8), 6.5, 1e-9);
}

// 2,000 sets of times with 2 % of noise: the standard error is the scatter of the fitted fractions. A standard
// deviation from 2,000 values is known to 1.6 %; linearising in 2 % of noise, and the root mean square of errors that
// have four degrees of freedom each, leave some percent more.
TEST(Amdahl, TheStandardErrorIsTheScatterOfFits) {
    constexpr double serial = 0.1, noise = 0.02;
    constexpr int sets = 2000;
    std::mt19937 generator(7);
    std::normal_distribution<double> normal(0, noise);
    double sum = 0, squares = 0, stated = 0;
    for (int set = 0; set < sets; ++set) {
        auto times = times_of(serial, 3, {1, 2, 3, 4, 6, 8});
        for (ThreadTime& entry : times) entry.time *= 1 + normal(generator);
        const auto fit = fit_amdahl(times);
        ASSERT_TRUE(fit);
        sum += fit->serial_fraction;
        squares += fit->serial_fraction * fit->serial_fraction;
        stated += fit->standard_error * fit->standard_error;
    }
    const double mean = sum / sets;
    const double scatter = std::sqrt(squares / sets - mean * mean);
    EXPECT_NEAR(mean, serial, 4 * scatter / std::sqrt(sets) + noise * noise);
    EXPECT_NEAR(std::sqrt(stated / sets) / scatter, 1, 0.08);
}

TEST(Amdahl, NeedsThreeThreadCounts) {
    EXPECT_FALSE(fit_amdahl({}));
    EXPECT_FALSE(fit_amdahl(times_of(0.1, 1, {1, 2})));
    EXPECT_FALSE(fit_amdahl(times_of(0.1, 1, {1, 2, 2, 1, 2})));
    EXPECT_TRUE(fit_amdahl(times_of(0.1, 1, {1, 2, 3})));
}

TEST(Amdahl, RefusesWhatIsNoTime) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    for (const ThreadTime bad : {ThreadTime{0, 1}, ThreadTime{2, 0}, ThreadTime{2, -1}, ThreadTime{2, infinite},
                                 ThreadTime{2, std::nan("")}}) {
        EXPECT_THROW((void)fit_amdahl(std::array{ThreadTime{1, 1}, bad}), Error);
    }
}

}  // namespace
}  // namespace lancet::experiments::scaling
