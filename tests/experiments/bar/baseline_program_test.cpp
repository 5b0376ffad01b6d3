// The two baselines as the programs that they are.

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "lancet/experiments/bar/errors.hpp"
#include "lancet/experiments/bar/reference.hpp"
#include "lancet/experiments/bar/workers.hpp"
#include "lancet/experiments/common/process.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::bar {
namespace {

using Arguments = std::vector<std::string>;

struct Outcome {
    WorkerReport report;
    std::vector<std::vector<double>> snapshots;
};

Outcome run(const std::string& method, Arguments arguments, const ProblemOptions& problem,
            const std::vector<double>& times, int threads = 1) {
    arguments.push_back("--threads=" + std::to_string(threads));
    const Job job{method, "test", std::filesystem::path(LANCET_BAR_FOLDER) / ("bar_" + method), arguments, threads};
    Outcome outcome;
    outcome.report = run_worker(job, problem, times, make_problem(problem).mesh.nodes().size(), outcome.snapshots);
    return outcome;
}

ProblemOptions small_bar() {
    ProblemOptions options;
    options.cells = {10, 2, 2};
    options.steps = 50;
    return options;
}

double distance_percent(const ProblemOptions& options, const Outcome& a, const Outcome& b) {
    const Problem problem = make_problem(options);
    double largest = 0;
    for (std::size_t i = 0; i < a.snapshots.size(); ++i) {
        largest = std::max(largest, error_percent(problem, a.snapshots[i], b.snapshots[i]));
    }
    return largest;
}

struct Case {
    const char* name;
    Arguments arguments;
    std::array<double, 2> rayleigh;
};

class Baselines : public testing::TestWithParam<Case> {};

TEST_P(Baselines, GiveOneTrajectoryWithEveryScalarAndThreadCount) {
    ProblemOptions options = small_bar();
    options.rayleigh = GetParam().rayleigh;
    const auto with = [](Arguments arguments, const Arguments& more) {
        arguments.insert(arguments.end(), more.begin(), more.end());
        return arguments;
    };
    const Arguments tight = with(GetParam().arguments, {"--scalar=double", "--cg-tolerance=1e-13"});
    const Arguments single = with(GetParam().arguments, {"--scalar=float", "--cg-tolerance=1e-6"});
    const Outcome eigen = run("eigen", tight, options, {1, 2});
    EXPECT_GT(error_percent(make_problem(options), eigen.snapshots[0], eigen.snapshots[1]), 1.0) << "it must move";
    EXPECT_LT(distance_percent(options, run("thesis", tight, options, {1, 2}), eigen), 1e-8);
    EXPECT_LT(distance_percent(options, run("thesis", tight, options, {1, 2}, 2), eigen), 1e-8);
    EXPECT_LT(distance_percent(options, run("eigen", tight, options, {1, 2}, 2), eigen), 1e-8);
    EXPECT_LT(distance_percent(options, run("thesis", single, options, {1, 2}), eigen), 1e-2);
    EXPECT_LT(distance_percent(options, run("eigen", single, options, {1, 2}), eigen), 1e-2);
    const Arguments incomplete = with(tight, {"--preconditioner=incomplete-cholesky"});
    EXPECT_LT(distance_percent(options, run("eigen", incomplete, options, {1, 2}), eigen), 1e-8);
    const Arguments diagonal = with(tight, {"--preconditioner=diagonal"});
    EXPECT_LT(distance_percent(options, run("eigen", diagonal, options, {1, 2}), eigen), 1e-8);
}

INSTANTIATE_TEST_SUITE_P(
    Bar, Baselines,
    testing::Values(Case{"state", {"--linearise=state"}, {0, 0}},
                    Case{"prediction", {"--linearise=prediction"}, {0, 0}},
                    Case{"state_damped", {"--linearise=state"}, {0.3, 0.02}},
                    Case{"prediction_damped", {"--linearise=prediction"}, {0.3, 0.02}},
                    Case{"state_interval", {"--linearise=state", "--rotation-interval=5"}, {0, 0}},
                    Case{"prediction_interval", {"--linearise=prediction", "--rotation-interval=5"}, {0, 0}}),
    [](const auto& information) { return std::string(information.param.name); });

TEST(Baselines, FreeFallIsExact) {
    ProblemOptions options = small_bar();
    // Fixed at the far end: the free end falls freely until the elastic wave arrives, which here takes far longer.
    options.young_modulus = 1e-9;
    options.steps = 25;
    const Problem problem = make_problem(options);
    for (const char* method : {"thesis", "eigen"}) {
        const Outcome outcome = run(method, {"--scalar=double"}, options, {1});
        // Implicit Euler: y = -g dt^2 n (n + 1) / 2.
        const double fall = -9.81 * 0.04 * 0.04 * 25 * 26 / 2;
        const std::size_t last = problem.mesh.nodes().size() - 1;
        EXPECT_NEAR(outcome.snapshots[0][3 * last + 1] - problem.mesh.nodes()[last][1], fall, 1e-9) << method;
    }
}

TEST(Baselines, CountsAndTimesAddUp) {
    const ProblemOptions options = small_bar();
    for (const char* method : {"thesis", "eigen"}) {
        const WorkerReport report = run(method, {"--cg-iterations=7"}, options, {}).report;
        EXPECT_EQ(report.method, method);
        EXPECT_EQ(report.elements, 200);
        EXPECT_EQ(report.nodes, 99);
        EXPECT_EQ(report.steps, 50);
        EXPECT_EQ(report.cg_iterations_total, 350) << method;
        EXPECT_NEAR(report.seconds_forces + report.seconds_solve + report.seconds_rest, report.seconds_total, 1e-9);
        EXPECT_GT(report.seconds_rest, 0);
        EXPECT_GT(report.solve_flops, 0);
        EXPECT_GT(report.bytes, 200 * 100);
    }
}

/// Deflection of the middle of the free end at rest.
double tip_deflection(ProblemOptions options) {
    const Problem problem = make_problem(options);
    options = to_rest(options, problem);
    const Outcome outcome =
        run("eigen", {"--scalar=double", "--linearise=prediction", "--preconditioner=diagonal", "--cg-tolerance=1e-6"},
            options, {options.steps * options.time_step});
    const auto nodes = problem.mesh.nodes();
    for (std::size_t node = 0; node < nodes.size(); ++node) {
        const mesh::Point centre{4.0, 0.4, 0.4};
        double distance = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) distance += std::abs(nodes[node][axis] - centre[axis]);
        if (distance < 1e-9) return nodes[node][1] - outcome.snapshots[0][3 * node + 1];
    }
    ADD_FAILURE() << "no node in the middle of the free end";
    return 0;
}

TEST(Baselines, RestStateApproachesTheReferenceFromTheStiffSide) {
    // reference: corotational hexahedra with 20 nodes, finest mesh (standards/bar_gravity.csv)
    constexpr double reference = 3.12573517;
    ProblemOptions options;
    options.cells = {10, 2, 2};
    const double coarse = tip_deflection(options);
    options.cells = {20, 4, 4};
    const double fine = tip_deflection(options);
    EXPECT_LT(coarse, fine);
    EXPECT_LT(fine, reference);
    EXPECT_LT(reference - fine, 0.6 * (reference - coarse));
    EXPECT_GT(fine, 0.8 * reference);
}

int exit_code(const std::string& method, const Arguments& arguments) {
    Command command;
    command.program = std::filesystem::path(LANCET_BAR_FOLDER) / ("bar_" + method);
    command.arguments = arguments;
    const ProcessResult result = run_process(command);
    const auto* exited = std::get_if<Exited>(&result.end);
    return exited == nullptr ? -1 : exited->code;
}

TEST(Baselines, RefuseBadInputWithExitCode2) {
    for (const char* method : {"thesis", "eigen"}) {
        EXPECT_EQ(exit_code(method, {"--help"}), 0);
        for (const Arguments& bad : std::vector<Arguments>{{"--scalar=half"},
                                                           {"--threads=0"},
                                                           {"--cg-iterations=0"},
                                                           {"--cg-tolerance=2"},
                                                           {"--cg-tolerance=1e-3", "--cg-iterations=5"},
                                                           {"--rotation-interval=0"},
                                                           {"--linearise=future"},
                                                           {"--preconditioner=magic"},
                                                           {"--poisson=0.5"},
                                                           {"--fix=nothing"},
                                                           {"--nonsense"},
                                                           {"--snapshot-times=1"}}) {
            EXPECT_EQ(exit_code(method, bad), 2) << method << " " << bad.front();
        }
    }
    EXPECT_EQ(exit_code("thesis", {"--preconditioner=diagonal"}), 2);
    EXPECT_EQ(exit_code("eigen", {"--newton-tolerance=1e-8"}), 2);
}

TEST(Workers, AFailureIsAnError) {
    ProblemOptions options = small_bar();
    EXPECT_THROW((void)run("eigen", {"--preconditioner=magic"}, options, {}), Error);
    EXPECT_THROW((void)run("absent", {}, options, {}), Error);
}

}  // namespace
}  // namespace lancet::experiments::bar
