// The worker of `scaling`: one benchmark, solved once by Lancet in this process, with what the machine did meanwhile.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "lancet/experiments/bar/energy.hpp"
#include "lancet/experiments/bar/errors.hpp"
#include "lancet/experiments/bar/lancet_options.hpp"
#include "lancet/experiments/common/hash.hpp"
#include "lancet/experiments/common/machine_limits.hpp"
#include "lancet/experiments/common/main.hpp"
#include "lancet/experiments/common/options.hpp"
#include "lancet/experiments/scaling/pinning.hpp"
#include "lancet/experiments/scaling/problem.hpp"
#include "lancet/experiments/scaling/report.hpp"
#include "lancet/runtime/observe/clock.hpp"
#include "lancet/runtime/observe/machine.hpp"
#include "lancet/runtime/simulate/body.hpp"
#include "lancet/runtime/simulate/scene_layout.hpp"

namespace {

using namespace lancet;
using namespace lancet::experiments;
using namespace lancet::experiments::scaling;

struct Options {
    std::string benchmark = "bar";
    int elements = 12'800;
    int steps = 125;
    bar::LancetOptions lancet;
    bar::SnapshotOptions snapshots;
    std::string reference;  ///< file of the converged solution at error_time; empty: none
    bool natural_order = false;
    bool pin = false;
    bool limits = false;
};

void add_options(CLI::App& app, Options& o) {
    app.add_option("--problem", o.benchmark, "bar or organ")->check(CLI::IsMember(benchmark_names()));
    app.add_option("--elements", o.elements, "Elements, about");
    app.add_option("--steps", o.steps, "Number of time steps");
    app.add_option("--reference", o.reference, "Converged positions at t = 1 s, as --snapshots writes them")
        ->type_name("FILE");
    app.add_flag("--natural-order", o.natural_order, "One block of nodes, as a program without threads would have");
    app.add_flag("--pin", o.pin, "Hold every thread to a core");
    app.add_flag("--limits", o.limits, "Measure what these threads can do at most, too");
    bar::add_lancet_options(app, o.lancet);
    bar::add_snapshot_options(app, o.snapshots);
}

std::span<const double> flat(const std::vector<mesh::Point>& points) {
    return {points.front().data(), 3 * points.size()};
}

/// One block, with as many aggregates in the coarse space as the blocks have together: the same method at the same
/// error.
kernels::NumberingOptions one_block(const runtime::Scene& scene, const runtime::Settings& settings) {
    const kernels::NodeNumbering usual = runtime::number_scene(scene, settings.ordering, settings.numbering);
    const auto free =
        std::ranges::count_if(usual.internal_of_user, [&usual](std::int32_t node) { return usual.is_free(node); });
    const auto nodes_per_aggregate =
        static_cast<int>(std::lround(static_cast<double>(free) / std::max(1, usual.aggregates())));
    return {.nodes_per_block = std::numeric_limits<int>::max() / 2,
            .nodes_per_aggregate = std::max(1, nodes_per_aggregate)};
}

struct Timed {
    double seconds = 0;
    std::vector<double> positions_at_error_time;
};

/// All steps; what is looked at between them is not timed.
Timed take_steps(runtime::DeformableBody& body, runtime::Scheduler& scheduler, const bar::Problem& problem,
                 bar::Snapshots& snapshots) {
    Timed timed;
    std::vector<mesh::Point> positions(body.nodes());
    const auto error_step = static_cast<int>(std::round(error_time / problem.time_step));
    for (int step = 1; step <= problem.steps; ++step) {
        const double begin = runtime::steady_seconds();
        body.step(scheduler);
        timed.seconds += runtime::steady_seconds() - begin;
        if (step != error_step) continue;
        body.positions(positions);
        timed.positions_at_error_time.assign(flat(positions).begin(), flat(positions).end());
        if (snapshots.wanted(step)) snapshots.add(flat(positions));
    }
    return timed;
}

void measure_limits(Report& report, const runtime::Settings& settings, double bytes, runtime::Scheduler& scheduler) {
    MachineLimits limits(scheduler);
    report.peak_gflops = settings.scalar == runtime::ScalarMode::double_precision
                             ? limits.peak_gflops<double>(settings.instruction_set)
                             : limits.peak_gflops<float>(settings.instruction_set);
    report.read_gbytes_per_s = limits.read_gbytes_per_s(std::max(bytes, 4096.0 * scheduler.threads()));
}

Report simulate(const Benchmark& benchmark, const Options& options, bar::Snapshots& snapshots, LoadMeter& meter) {
    const bar::Problem& problem = benchmark.problem;
    const bar::LancetOptions& words = options.lancet;
    runtime::Settings settings = bar::settings_of(words, problem);
    settings.model = benchmark.model;
    const runtime::Scene scene = scene_of(benchmark);
    if (options.natural_order) settings.numbering = one_block(scene, settings);
    Report report;
    report.cores = runtime::cores_allowed();  // before this thread may be held to one
    const double begin = runtime::steady_seconds();
    const auto scheduler = runtime::make_scheduler(runtime::scheduler_from_string(words.scheduler), words.threads);
    if (options.pin) report.pinned_threads = pin_threads(*scheduler);
    const auto body = runtime::make_body(scene, settings, *scheduler);
    report.run.seconds_setup = runtime::steady_seconds() - begin;

    meter.begin(*scheduler);
    const Timed timed = take_steps(*body, *scheduler, problem, snapshots);
    meter.end(*scheduler);

    bar::WorkerReport& run = report.run;
    const runtime::StepTotals& totals = body->totals();
    const auto work = body->solve_work();
    run.method = "lancet";
    run.variant = words.preconditioner + (body->blocks() == 1 ? ", one block" : "");
    run.operator_ = words.matrix;
    run.scalar = words.scalar;
    run.isa = kernels::to_string(body->settings().instruction_set);
    run.scheduler = words.scheduler;
    run.threads = scheduler->threads();
    run.elements = static_cast<std::int64_t>(body->elements());
    run.nodes = static_cast<std::int64_t>(body->nodes());
    run.steps = problem.steps;
    run.seconds_total = timed.seconds;
    run.seconds_forces = totals.seconds_forces;
    run.seconds_solve = totals.seconds_solve;
    run.seconds_rest = run.seconds_total - run.seconds_forces - run.seconds_solve;
    run.cg_iterations_total = totals.conjugate_gradient_iterations;
    run.repeats_total = totals.repeats;
    run.bytes = static_cast<std::int64_t>(body->bytes());
    run.solve_flops = work.flops * static_cast<double>(totals.conjugate_gradient_iterations);
    run.solve_bytes = work.bytes * static_cast<double>(totals.conjugate_gradient_iterations);

    std::vector<mesh::Point> positions(body->nodes()), velocities(body->nodes());
    body->positions(positions);
    body->velocities(velocities);
    run.energy_final = bar::energy(problem, flat(positions), flat(velocities)).total();
    Hash hash;
    hash.add(flat(positions));
    hash.add(flat(velocities));
    report.state = hash.text();
    if (!options.reference.empty() && !timed.positions_at_error_time.empty()) {
        const auto reference = bar::read_snapshots(options.reference, 1, body->nodes()).front();
        report.error_percent = bar::error_percent(problem, timed.positions_at_error_time, reference);
    }
    const char* policy = std::getenv("OMP_WAIT_POLICY");
    report.omp_wait_policy = policy == nullptr ? "unset" : policy;
    if (options.limits) measure_limits(report, body->settings(), work.bytes, *scheduler);
    report.load = meter.finish();
    return report;
}

ExitCode body(int argc, const char* const* argv) {
    LoadMeter meter;
    CLI::App app("Lancet on one benchmark, once: prints its report as a line of JSON");
    Options options;
    add_options(app, options);
    if (!parse_command_line(app, argc, argv)) return ExitCode::success;
    const Benchmark benchmark = make_benchmark(options.benchmark, options.elements, options.steps);
    bar::Snapshots snapshots(options.snapshots, benchmark.problem);
    const Report report = simulate(benchmark, options, snapshots, meter);
    snapshots.write();
    std::cout << to_line(report) << std::endl;
    return ExitCode::success;
}

}  // namespace

int main(int argc, char** argv) {
    return run_main(argc, argv, body);
}
