#include "lancet/experiments/bar/problem.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/experiments/common/options.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::bar {
namespace {

using testing::HasSubstr;

ProblemOptions parsed(const std::vector<std::string>& arguments) {
    CLI::App app;
    ProblemOptions options;
    add_problem_options(app, options);
    std::vector<const char*> words{"bar"};
    for (const std::string& argument : arguments) words.push_back(argument.c_str());
    EXPECT_TRUE(parse_command_line(app, static_cast<int>(words.size()), words.data()));
    return options;
}

std::string refusal(const std::vector<std::string>& arguments) {
    try {
        (void)make_problem(parsed(arguments));
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

TEST(BarProblem, DefaultIsTheBarOfTheThesis) {
    const Problem problem = make_problem(parsed({}));
    EXPECT_EQ(problem.mesh.tetrahedra().size(), 12800u);
    EXPECT_EQ(problem.mesh.nodes().size(), 3321u);
    EXPECT_EQ(problem.fixed_nodes.size(), 81u);
    for (const std::int32_t node : problem.fixed_nodes) {
        EXPECT_EQ(problem.mesh.nodes()[static_cast<std::size_t>(node)][0], 0.0);
    }
    EXPECT_DOUBLE_EQ(problem.length, 4.0);
    EXPECT_DOUBLE_EQ(problem.time_step * problem.steps, 5.0);
    EXPECT_DOUBLE_EQ(problem.gravity[1], -9.81);
}

TEST(BarProblem, WorkersGetTheSameOptionsBitForBit) {
    const ProblemOptions options =
        parsed({"--cells", "3,2,1", "--size=0.3,0.2,0.1", "--split", "6", "--fix", "-1,-1,-1,0.05,1,1", "--material",
                "12345.678,0.3333333333333333,1e3", "--rayleigh", "0.1,0.30000000000000004", "--gravity", "-1,0.1,-3",
                "--time-step", "0.016666666666666666", "--steps", "7"});
    const ProblemOptions again = parsed(problem_arguments(options));
    EXPECT_EQ(again.cells, options.cells);
    EXPECT_EQ(again.size, options.size);
    EXPECT_EQ(again.split, 6);
    EXPECT_EQ(again.fix, options.fix);
    EXPECT_EQ(again.young_modulus, 12345.678);
    EXPECT_EQ(again.poisson_ratio, 0.3333333333333333);
    EXPECT_EQ(again.density, 1e3);
    EXPECT_EQ(again.rayleigh, options.rayleigh);
    EXPECT_EQ(again.gravity, (std::array<double, 3>{-1, 0.1, -3}));
    EXPECT_EQ(again.time_step, 0.016666666666666666);
    EXPECT_EQ(again.steps, 7);
}

TEST(BarProblem, FixedNodesByBoxSetAndEnd) {
    const Problem problem = make_problem(parsed({"--cells", "4,2,2", "--fix", "3.9,0,0,4,0.8,0.8"}));
    EXPECT_EQ(problem.fixed_nodes.size(), 9u);
    EXPECT_EQ(fixed_nodes(problem.mesh, "x_max"), problem.fixed_nodes);
    const auto low_end = fixed_nodes(problem.mesh, "auto");
    EXPECT_EQ(low_end, fixed_nodes(problem.mesh, "x_min"));
    EXPECT_TRUE(std::is_sorted(low_end.begin(), low_end.end()));
}

TEST(BarProblem, RefusesWhatHasNoMeaning) {
    EXPECT_THAT(refusal({"--cells", "0,1,1"}), HasSubstr("--cells"));
    EXPECT_THAT(refusal({"--cells", "4,4"}), HasSubstr("--cells"));
    EXPECT_THAT(refusal({"--cells", "4,4,4,4"}), HasSubstr("--cells"));
    EXPECT_THAT(refusal({"--cells", "4,x,4"}), HasSubstr("--cells"));
    EXPECT_THAT(refusal({"--size", "1,1,-1"}), HasSubstr("--size"));
    EXPECT_THAT(refusal({"--size", "1,nan,1"}), HasSubstr("--size"));
    EXPECT_THAT(refusal({"--split", "4"}), HasSubstr("--split"));
    EXPECT_THAT(refusal({"--young", "0"}), HasSubstr("--young"));
    EXPECT_THAT(refusal({"--young", "inf"}), HasSubstr("--young"));
    EXPECT_THAT(refusal({"--poisson", "0.5"}), HasSubstr("--poisson"));
    EXPECT_THAT(refusal({"--poisson", "-1"}), HasSubstr("--poisson"));
    EXPECT_THAT(refusal({"--poisson", "nan"}), HasSubstr("--poisson"));
    EXPECT_THAT(refusal({"--density", "-100"}), HasSubstr("--density"));
    EXPECT_THAT(refusal({"--material", "1e5,0.3"}), HasSubstr("--material"));
    EXPECT_THAT(refusal({"--material", "1e5,0.3,10", "--young", "2"}), HasSubstr("--material"));
    EXPECT_THAT(refusal({"--rayleigh", "0,-1"}), HasSubstr("--rayleigh"));
    EXPECT_THAT(refusal({"--gravity", "0,inf,0"}), HasSubstr("--gravity"));
    EXPECT_THAT(refusal({"--time-step", "0"}), HasSubstr("--time-step"));
    EXPECT_THAT(refusal({"--time-step", "nan"}), HasSubstr("--time-step"));
    EXPECT_THAT(refusal({"--steps", "0"}), HasSubstr("--steps"));
    EXPECT_THAT(refusal({"--fix", "9,9,9,10,10,10"}), HasSubstr("no node lies"));
    EXPECT_THAT(refusal({"--fix", "-9,-9,-9,10,10,10"}), HasSubstr("holds all"));
    EXPECT_THAT(refusal({"--fix", "1,0,0,0,1,1"}), HasSubstr("min <= max"));
    EXPECT_THAT(refusal({"--fix", "handle"}), HasSubstr("x_min"));
    EXPECT_THAT(refusal({"--mesh", "nowhere.msh"}), HasSubstr("nowhere.msh"));
}

TEST(BarProblem, ReadsARealMeshAndFixesItsLowEnd) {
    const std::filesystem::path file = std::filesystem::path(LANCET_SHARED_DIR) / "meshes" / "liver.msh";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "the folder of real meshes is absent: " << file;
    const Problem problem = make_problem(parsed({"--mesh", file.string(), "--mesh-scale", "0.01"}));
    EXPECT_EQ(problem.mesh.nodes().size(), 181u);
    EXPECT_FALSE(problem.fixed_nodes.empty());
    const auto bounds = problem.mesh.bounds();
    double longest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) longest = std::max(longest, bounds[1][axis] - bounds[0][axis]);
    EXPECT_DOUBLE_EQ(problem.length, longest);
    EXPECT_THAT(refusal({"--mesh", file.string(), "--mesh-scale", "0"}), HasSubstr("--mesh-scale"));
}

}  // namespace
}  // namespace lancet::experiments::bar
