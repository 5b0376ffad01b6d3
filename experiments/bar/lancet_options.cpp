#include "lancet/experiments/bar/lancet_options.hpp"

#include <CLI/CLI.hpp>

namespace lancet::experiments::bar {

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

}  // namespace lancet::experiments::bar
