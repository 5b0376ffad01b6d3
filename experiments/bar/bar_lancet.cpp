// The worker of `bar` that runs Lancet itself: the same protocol as the baselines.

#include <iostream>
#include <string>

#include <CLI/CLI.hpp>

#include "lancet/experiments/bar/energy.hpp"
#include "lancet/experiments/bar/lancet_options.hpp"
#include "lancet/experiments/bar/worker.hpp"
#include "lancet/experiments/common/main.hpp"
#include "lancet/experiments/common/options.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/runtime/observe/clock.hpp"
#include "lancet/runtime/simulate/body.hpp"

namespace {

using namespace lancet;
using namespace lancet::experiments;
using namespace lancet::experiments::bar;

std::span<const double> flat(const std::vector<mesh::Point>& points) {
    return {points.front().data(), 3 * points.size()};
}

WorkerReport simulate(const Problem& problem, const LancetOptions& options, Snapshots& snapshots) {
    WorkerReport report;
    const double begin = runtime::steady_seconds();
    const auto scheduler = runtime::make_scheduler(runtime::scheduler_from_string(options.scheduler), options.threads);
    const auto body = runtime::make_body(scene_of(problem), settings_of(options, problem), *scheduler);
    report.seconds_setup = runtime::steady_seconds() - begin;

    std::vector<mesh::Point> positions(body->nodes()), velocities(body->nodes());
    for (int step = 0; step < problem.steps; ++step) {
        const double step_begin = runtime::steady_seconds();
        body->step(*scheduler);
        report.seconds_total += runtime::steady_seconds() - step_begin;
        if (!snapshots.wanted(step + 1)) continue;
        body->positions(positions);
        snapshots.add(flat(positions));
    }
    const runtime::StepTotals& totals = body->totals();
    report.seconds_forces = totals.seconds_forces;
    report.seconds_solve = totals.seconds_solve;
    report.seconds_rest = report.seconds_total - report.seconds_forces - report.seconds_solve;
    report.cg_iterations_total = totals.conjugate_gradient_iterations;
    report.repeats_total = totals.repeats;
    report.bytes = static_cast<std::int64_t>(body->bytes());
    const auto work = body->solve_work();
    report.solve_flops = work.flops * static_cast<double>(totals.conjugate_gradient_iterations);
    report.solve_bytes = work.bytes * static_cast<double>(totals.conjugate_gradient_iterations);
    body->positions(positions);
    body->velocities(velocities);
    report.energy_final = energy(problem, flat(positions), flat(velocities)).total();
    report.method = "lancet";
    report.variant = options.preconditioner + (options.no_safeguard ? " unguarded" : "") +
                     (body->blocks() == 1 ? ", one block" : "");
    report.operator_ = options.matrix;
    report.scalar = options.scalar;
    report.isa = kernels::to_string(body->settings().instruction_set);
    report.scheduler = options.scheduler;
    report.threads = scheduler->threads();
    report.elements = static_cast<std::int64_t>(body->elements());
    report.nodes = static_cast<std::int64_t>(body->nodes());
    report.steps = problem.steps;
    return report;
}

ExitCode body(int argc, const char* const* argv) {
    CLI::App app("Lancet on one problem, once: prints its report as a line of JSON");
    ProblemOptions problem_options;
    LancetOptions options;
    SnapshotOptions snapshot_options;
    add_lancet_options(app, options);
    add_snapshot_options(app, snapshot_options);
    add_problem_options(app, problem_options);
    if (!parse_command_line(app, argc, argv)) return ExitCode::success;
    const Problem problem = make_problem(problem_options);
    Snapshots snapshots(snapshot_options, problem);
    const WorkerReport report = simulate(problem, options, snapshots);
    snapshots.write();
    std::cout << to_line(report) << std::endl;
    return ExitCode::success;
}

}  // namespace

int main(int argc, char** argv) {
    return run_main(argc, argv, body);
}
