#include "lancet/experiments/precision/pareto.hpp"

#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lancet::experiments::precision {
namespace {

using testing::ElementsAre;

TEST(ParetoFront, HoldsWhatNothingElseBeats) {
    const std::vector<TimeAndError> points{{1, 10}, {2, 5}, {3, 6}, {4, 1}, {0.5, 20}, {5, 1}};
    EXPECT_THAT(pareto_front(points, 0), ElementsAre(true, true, false, true, true, false));
}

TEST(ParetoFront, AsksForAGainThatIsWorthTheTime) {
    const std::vector<TimeAndError> points{{1, 10.0}, {2, 9.99}, {3, 9.8}};
    EXPECT_THAT(pareto_front(points, 0), ElementsAre(true, true, true));
    EXPECT_THAT(pareto_front(points, 0.01), ElementsAre(true, false, true));
}

TEST(ParetoFront, TakesEqualPointsTogether) {
    const std::vector<TimeAndError> points{{1, 2}, {1, 2}, {1, 3}, {2, 2}};
    EXPECT_THAT(pareto_front(points, 0), ElementsAre(true, true, false, false));
}

TEST(ParetoFront, LeavesOutWhatIsNotFinite) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<TimeAndError> points{{1, nan}, {nan, 1}, {2, 3}, {0.1, infinity}};
    EXPECT_THAT(pareto_front(points), ElementsAre(false, false, true, false));
    EXPECT_TRUE(pareto_front({}).empty());
}

/// Against the definition, on many random points.
TEST(ParetoFront, IsWhatItsDefinitionSays) {
    std::vector<TimeAndError> points;
    unsigned state = 7;
    const auto next = [&state] {
        state = state * 1664525u + 1013904223u;
        return static_cast<double>(state >> 20);
    };
    for (int i = 0; i < 300; ++i) points.push_back({next(), next()});
    const std::vector<bool> front = pareto_front(points, 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        bool is_beaten = false;
        for (const TimeAndError& q : points) {
            is_beaten = is_beaten || (q.seconds <= points[i].seconds && q.error <= points[i].error &&
                                      (q.seconds < points[i].seconds || q.error < points[i].error));
        }
        EXPECT_EQ(front[i], !is_beaten) << i;
    }
}

}  // namespace
}  // namespace lancet::experiments::precision
