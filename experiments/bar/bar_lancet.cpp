// The worker of `bar` that runs Lancet itself: the same protocol as the baselines.

#include <iostream>
#include <string>

#include <CLI/CLI.hpp>

#include "lancet/experiments/bar/energy.hpp"
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

struct LancetOptions {
    std::string scalar = "float";
    std::string isa;  ///< empty: the active one
    std::string scheduler{runtime::to_string(runtime::default_scheduler)};
    std::string matrix = "edge-blocks";
    std::string scatter = "private-copies";
    std::string preconditioner = "coarse";
    std::string linearise = "prediction";
    std::string rotation = "robust";
    std::string mass = "lumped";
    std::string ordering = "hilbert";
    int threads = 1;
    int cg_iterations = 10;
    double cg_tolerance = 0;
    int rotation_interval = 1;
    double newton_tolerance = 0;
    bool no_safeguard = false;
    int nodes_per_block = 0;
    int nodes_per_aggregate = 0;
    double coarse_change = runtime::Settings{}.coarse_change;
};

void add_lancet_options(CLI::App& app, LancetOptions& o) {
    app.add_option("--scalar", o.scalar, "float, mixed or double");
    app.add_option("--isa", o.isa, "Instruction set: scalar, sse2, avx2, avx512 or neon");
    app.add_option("--scheduler", o.scheduler, "serial, openmp, tbb or threads");
    app.add_option("--threads", o.threads, "Threads of the scheduler")->check(CLI::Range(1, 1024));
    app.add_option("--operator", o.matrix, "matrix-free, edge-blocks or block-rows");
    app.add_option("--scatter", o.scatter, "private-copies, coloring or node-gather");
    app.add_option("--preconditioner", o.preconditioner, "none, jacobi, block-jacobi or coarse");
    app.add_option("--linearise", o.linearise, "At the state (x_n) or the prediction (x_n + dt v_n)")
        ->check(CLI::IsMember({"state", "prediction"}));
    app.add_option("--rotation", o.rotation, "robust, quaternion, polar or svd")
        ->check(CLI::IsMember({"robust", "quaternion", "polar", "svd"}));
    app.add_option("--mass", o.mass, "lumped, weighted-diagonal, consistent or fraction");
    app.add_option("--ordering", o.ordering, "Of the nodes")->check(CLI::IsMember({"none", "hilbert", "rcm"}));
    app.add_option("--cg-iterations", o.cg_iterations, "Iterations of every solve, at most");
    app.add_option("--cg-tolerance", o.cg_tolerance, "End a solve when the preconditioned residual is so small");
    app.add_option("--rotation-interval", o.rotation_interval, "Update rotations and matrix every K-th step");
    app.add_option("--newton-tolerance", o.newton_tolerance, "Solve every step to this residual instead of once");
    app.add_flag("--no-safeguard", o.no_safeguard, "Accept steps that gain energy");
    app.add_option("--nodes-per-block", o.nodes_per_block, "Work unit of the schedulers; 0: chosen");
    app.add_option("--nodes-per-aggregate", o.nodes_per_aggregate, "Piece of the coarse space; 0: chosen");
    app.add_option("--coarse-change", o.coarse_change, "Change of an aggregate that renews the coarse space");
}

runtime::Settings settings_of(const LancetOptions& o, const Problem& problem) {
    runtime::Settings settings;
    settings.time_step = problem.time_step;
    settings.mass = runtime::mass_kind_from_string(o.mass);
    settings.scalar = runtime::scalar_mode_from_string(o.scalar);
    if (!o.isa.empty()) settings.instruction_set = kernels::instruction_set_from_string(o.isa);
    settings.matrix = runtime::operator_kind_from_string(o.matrix);
    settings.scatter = kernels::scatter_strategy_from_string(o.scatter);
    settings.rotation.method = o.rotation == "robust"       ? kernels::RotationMethod::robust
                               : o.rotation == "quaternion" ? kernels::RotationMethod::quaternion
                               : o.rotation == "polar"      ? kernels::RotationMethod::polar
                                                            : kernels::RotationMethod::svd;
    settings.rotation_interval = o.rotation_interval;
    settings.linearisation =
        o.linearise == "state" ? runtime::Linearisation::state : runtime::Linearisation::prediction;
    settings.conjugate_gradients = {.iterations = o.cg_iterations, .tolerance = o.cg_tolerance};
    settings.preconditioner = runtime::preconditioner_kind_from_string(o.preconditioner);
    settings.coarse_change = o.coarse_change;
    if (o.newton_tolerance > 0) {
        settings.newton_iterations = 100;
        settings.newton_tolerance = o.newton_tolerance;
    }
    settings.energy_safeguard =
        !o.no_safeguard && settings.linearisation == runtime::Linearisation::prediction && o.rotation_interval == 1;
    settings.ordering = o.ordering == "hilbert" ? mesh::OrderingKind::hilbert
                        : o.ordering == "rcm"   ? mesh::OrderingKind::reverse_cuthill_mckee
                                                : mesh::OrderingKind::none;
    settings.numbering = {.nodes_per_block = o.nodes_per_block, .nodes_per_aggregate = o.nodes_per_aggregate};
    return settings;
}

runtime::Scene scene_of(const Problem& problem) {
    runtime::Scene scene;
    scene.mesh = problem.mesh;
    scene.materials = {{0, {problem.young_modulus, problem.poisson_ratio, problem.density}}};
    scene.fixed_nodes = problem.fixed_nodes;
    scene.gravity = problem.gravity;
    scene.rayleigh_mass = problem.rayleigh_mass;
    scene.rayleigh_stiffness = problem.rayleigh_stiffness;
    return scene;
}

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
