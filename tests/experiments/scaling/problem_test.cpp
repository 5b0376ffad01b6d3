#include "lancet/experiments/scaling/problem.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::scaling {
namespace {

TEST(Benchmark, TheBarIsTheBar) {
    EXPECT_EQ(bar_cells(12'800), (std::array{40, 8, 8}));
    EXPECT_EQ(bar_cells(102'400), (std::array{80, 16, 16}));
    const Benchmark bar = make_benchmark("bar", 12'800, 125);
    EXPECT_EQ(bar.problem.mesh.tetrahedra().size(), 12'800U);
    EXPECT_EQ(bar.problem.mesh.nodes().size(), 3'321U);
    EXPECT_EQ(bar.problem.fixed_nodes.size(), 81U);
    EXPECT_EQ(bar.problem.length, 4);
    EXPECT_EQ(bar.model, runtime::ElementModel::corotational);
    EXPECT_FALSE(bar.floor);
}

// Elements per thread are constant in a weak series as far as whole cells allow.
TEST(Benchmark, SizesAreNearWhatIsAskedFor) {
    for (const int elements : {1'600, 3'200, 12'800, 25'600, 51'200, 102'400, 409'600}) {
        const auto [along, across, up] = bar_cells(elements);
        EXPECT_NEAR(5.0 * along * across * up / elements, 1, 0.03) << elements;
        EXPECT_NEAR(along / (5.0 * across), 1, 0.2) << elements;
        const auto [rings, layers] = organ_cells(elements);
        EXPECT_NEAR(18.0 * rings * rings * layers / elements, 1, 0.03) << elements;
    }
}

TEST(Benchmark, TheOrganFallsOntoTheFloor) {
    const Benchmark organ = make_benchmark("organ", 20'870, 125);
    EXPECT_NEAR(static_cast<double>(organ.problem.mesh.tetrahedra().size()), 20'870, 0.01 * 20'870);
    EXPECT_TRUE(organ.problem.fixed_nodes.empty());
    EXPECT_EQ(organ.model, runtime::ElementModel::linear);
    EXPECT_EQ(organ.problem.density, 1000);
    ASSERT_TRUE(organ.floor);
    const auto bounds = organ.problem.mesh.bounds();
    EXPECT_NEAR(bounds[1][0] - bounds[0][0], 1, 1e-12);
    EXPECT_NEAR(bounds[0][2] - organ.floor->point[2], 0.1, 1e-12);
    EXPECT_LT(organ.problem.gravity[2], 0);
    EXPECT_TRUE(scene_of(organ).floor);
}

TEST(Benchmark, ASolutionsNameDependsOnTheProblemButNotOnTheSteps) {
    const std::string key = solution_key(make_benchmark("bar", 1'600, 25));
    EXPECT_EQ(key, solution_key(make_benchmark("bar", 1'600, 125)));
    EXPECT_NE(key, solution_key(make_benchmark("bar", 3'200, 25)));
    EXPECT_NE(key, solution_key(make_benchmark("organ", 1'600, 25)));
}

TEST(Benchmark, RefusesNonsense) {
    EXPECT_THROW((void)make_benchmark("liver", 1'600, 25), Error);
    EXPECT_THROW((void)make_benchmark("bar", 99, 25), Error);
    EXPECT_THROW((void)make_benchmark("bar", 1'600, 0), Error);
}

}  // namespace
}  // namespace lancet::experiments::scaling
