// The worker of `precision` that finds static equilibria with Eigen alone, compiled for the machine as well as the
// compiler can: the same protocol as the workers of `bar`.

#include <iostream>
#include <string>

#include <CLI/CLI.hpp>

#include "lancet/experiments/bar/worker.hpp"
#include "lancet/experiments/common/main.hpp"
#include "lancet/experiments/common/options.hpp"
#include "lancet/experiments/common/peak_memory.hpp"
#include "lancet/experiments/common/table.hpp"
#include "lancet/experiments/precision/eigen_statics.hpp"
#include "lancet/runtime/observe/clock.hpp"

namespace {

using namespace lancet;
using namespace lancet::experiments;
using namespace lancet::experiments::precision;

struct Options {
    EigenStaticsOptions statics;
    std::string model = "corotational";
    std::string scalar = "double";
    int threads = 1;
};

template <class Scalar>
bar::WorkerReport find_rest(const bar::Problem& problem, const Options& options, bar::Snapshots& snapshots) {
    bar::WorkerReport report = bar::baseline_report("eigen", "csr", options.scalar, options.threads, problem);
    report.steps = 1;
    Eigen::setNbThreads(options.threads);
    const PeakMemory memory;
    const double begin = runtime::steady_seconds();
    EigenStatics<Scalar> statics(problem, options.statics);
    report.seconds_setup = runtime::steady_seconds() - begin;
    const EigenStaticsReport found = statics.solve();
    report.seconds_total = runtime::steady_seconds() - begin;
    report.bytes = memory.bytes().value_or(0);
    report.cg_iterations_total = found.iterations;
    report.solve_flops = found.flops;
    const std::string iterations = std::to_string(found.newton_iterations) + " Newton iterations";
    report.variant = found.converged ? "converged"
                     : found.gave_up ? "too slow: given up after " + iterations
                                     : "stagnated: the residual stays at " + format_number(found.residual, 3) +
                                           " of the loads after " + iterations;
    if (snapshots.wanted(1)) snapshots.add(statics.positions());
    return report;
}

ExitCode body(int argc, const char* const* argv) {
    CLI::App app("Static equilibrium of one problem with Eigen: prints its report as a line of JSON");
    bar::ProblemOptions problem_options;
    bar::SnapshotOptions snapshot_options;
    Options options;
    app.add_option("--model", options.model, "linear or corotational")
        ->check(CLI::IsMember({"linear", "corotational"}));
    app.add_option("--scalar", options.scalar, "float or double")->check(CLI::IsMember({"float", "double"}));
    app.add_option("--preconditioner", options.statics.preconditioner,
                   "Of the conjugate gradients: diagonal or incomplete-cholesky; or ldlt, the direct solver")
        ->check(CLI::IsMember({"diagonal", "incomplete-cholesky", "ldlt"}));
    app.add_option("--tolerance", options.statics.tolerance, "Of the residual, relative to the load")
        ->check(CLI::Range(1e-14, 1.0));
    app.add_option("--threads", options.threads, "OpenMP threads of the products")->check(CLI::Range(1, 1024));
    app.add_option("--limit", options.statics.longest_seconds,
                   "Begin no Newton iteration after so many seconds of processor time")
        ->check(CLI::PositiveNumber);
    app.add_option("--end-load", options.statics.end_load, "Force in N on the face of largest x")->delimiter(',');
    bar::add_snapshot_options(app, snapshot_options);
    bar::add_problem_options(app, problem_options);
    if (!parse_command_line(app, argc, argv)) return ExitCode::success;
    options.statics.corotational = options.model == "corotational";
    options.statics.threads = options.threads;

    const bar::Problem problem = bar::make_problem(problem_options);
    bar::Snapshots snapshots(snapshot_options, problem);
    const bool is_float = options.scalar == "float";
    const bar::WorkerReport report =
        is_float ? find_rest<float>(problem, options, snapshots) : find_rest<double>(problem, options, snapshots);
    snapshots.write();
    std::cout << bar::to_line(report) << std::endl;
    return ExitCode::success;
}

}  // namespace

int main(int argc, char** argv) {
    return run_main(argc, argv, body);
}
