#include "lancet/experiments/bar/errors.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::bar {
namespace {

Problem small_problem(double time_step = 0.04, int steps = 125) {
    ProblemOptions options;
    options.cells = {2, 1, 1};
    options.time_step = time_step;
    options.steps = steps;
    return make_problem(options);
}

std::vector<double> shifted(const Problem& problem, double x, double y) {
    std::vector<double> positions;
    for (const mesh::Point& p : problem.mesh.nodes()) positions.insert(positions.end(), {p[0] + x, p[1] + y, p[2]});
    return positions;
}

TEST(ErrorPercent, OfAShiftIsItsLengthInPercentOfTheBody) {
    const Problem problem = small_problem();  // 4 m long
    EXPECT_NEAR(error_percent(problem, shifted(problem, 0.3, 0.4), shifted(problem, 0, 0)), 12.5, 1e-12);
    EXPECT_EQ(error_percent(problem, shifted(problem, 1, 1), shifted(problem, 1, 1)), 0.0);
    EXPECT_THROW((void)error_percent(problem, shifted(problem, 0, 0), {}), Error);
    auto diverged = shifted(problem, 0, 0);
    diverged[5] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(std::isnan(error_percent(problem, diverged, shifted(problem, 0, 0))));
}

TEST(ErrorTimes, AreThoseThatAStepReaches) {
    EXPECT_EQ(error_times(small_problem()), (std::vector<double>{1, 5}));
    EXPECT_EQ(error_times(small_problem(0.04, 124)), (std::vector<double>{1}));
    EXPECT_EQ(error_times(small_problem(1.0 / 60, 60)), (std::vector<double>{1}));
    EXPECT_EQ(error_times(small_problem(0.04, 24)), (std::vector<double>{}));
    EXPECT_EQ(error_times(small_problem(0.03, 500)), (std::vector<double>{}));
    EXPECT_EQ(error_times(small_problem(2.5, 2)), (std::vector<double>{5}));
}

TEST(ErrorsOf, AreMissingWithoutAReference) {
    const Problem problem = small_problem();
    const std::vector<std::vector<double>> snapshots{shifted(problem, 0.04, 0), shifted(problem, 0.08, 0)};
    Reference reference;
    reference.times = {1, 5};
    const Errors none = errors_of(problem, reference, snapshots, {});
    EXPECT_FALSE(none.t1 || none.t5 || none.t1_dt0 || none.rest);
    reference.positions = {shifted(problem, 0, 0), shifted(problem, 0, 0)};
    reference.positions_t1_dt0 = shifted(problem, 0.02, 0);
    reference.positions_rest = shifted(problem, 0, 0.4);
    const Errors all = errors_of(problem, reference, snapshots, shifted(problem, 0, 0));
    EXPECT_NEAR(*all.t1, 1, 1e-12);
    EXPECT_NEAR(*all.t5, 2, 1e-12);
    EXPECT_NEAR(*all.t1_dt0, 0.5, 1e-12);
    EXPECT_NEAR(*all.rest, 10, 1e-12);
    EXPECT_FALSE(errors_of(problem, reference, snapshots, {}).rest);
}

}  // namespace
}  // namespace lancet::experiments::bar
