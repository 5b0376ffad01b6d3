#include "lancet/experiments/bar/baseline.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>

#include <CLI/CLI.hpp>

#include "lancet/experiments/bar/energy.hpp"
#include "lancet/experiments/common/main.hpp"
#include "lancet/experiments/common/options.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/mesh/node_graph.hpp"
#include "lancet/runtime/observe/clock.hpp"

namespace lancet::experiments::bar {
namespace {

constexpr int iterations_to_tolerance = 100'000;

void add_baseline_options(CLI::App& app, BaselineOptions& options, const BaselineProgram& program) {
    app.add_option("--scalar", options.scalar, "float or double")->check(CLI::IsMember({"float", "double"}));
    app.add_option("--threads", options.threads, "OpenMP threads")->check(CLI::Range(1, 1024));
    auto* iterations = app.add_option("--cg-iterations", options.cg_iterations, "Iterations of every solve")
                           ->check(CLI::Range(1, iterations_to_tolerance));
    app.add_option_function<double>(
           "--cg-tolerance",
           [&options](double tolerance) {
               if (!(tolerance > 0 && tolerance < 1)) throw Error("--cg-tolerance: expected a number between 0 and 1");
               options.cg_tolerance = tolerance;
               options.cg_iterations = iterations_to_tolerance;
           },
           "Solve until the residual is so small, relative to the right-hand side, instead")
        ->excludes(iterations);
    app.add_option("--rotation-interval", options.rotation_interval, "Update rotations and matrix every K-th step")
        ->check(CLI::Range(1, 1'000'000));
    app.add_option_function<std::string>(
           "--linearise",
           [&options](const std::string& where) {
               options.linearisation = where == "state" ? Linearisation::state : Linearisation::prediction;
           },
           "Where matrix and forces are evaluated: state (x_n) or prediction (x_n + dt v_n)")
        ->check(CLI::IsMember({"state", "prediction"}));
    app.add_option("--preconditioner", options.preconditioner, "Of the conjugate gradients")
        ->check(CLI::IsMember(program.preconditioners));
    if (program.newton) {
        app.add_option("--newton-tolerance", options.newton_tolerance,
                       "Solve each implicit Euler step until its residual is so small, relative to the load, instead "
                       "of once")
            ->check(CLI::Range(0.0, 1.0));
    }
}

WorkerReport simulate(const Problem& problem, const BaselineOptions& options, const BaselineProgram& program,
                      Snapshots& snapshots) {
    WorkerReport report = baseline_report(program.method, program.operator_, options.scalar, options.threads, problem);
    report.variant = options.preconditioner;
    const double begin = runtime::steady_seconds();
    const auto make = options.scalar == "float" ? program.make_float : program.make_double;
    const std::unique_ptr<BaselineSolver> solver = make(problem, options);
    report.seconds_setup = runtime::steady_seconds() - begin;

    for (int step = 0; step < problem.steps; ++step) {
        const double step_begin = runtime::steady_seconds();
        const StepCost cost = solver->step(step % options.rotation_interval == 0);
        report.seconds_total += runtime::steady_seconds() - step_begin;
        report.seconds_forces += cost.seconds_forces;
        report.seconds_solve += cost.seconds_solve;
        report.cg_iterations_total += cost.cg_iterations;
        report.solve_flops += cost.solve_flops;
        report.solve_bytes += cost.solve_bytes;
        if (snapshots.wanted(step + 1)) snapshots.add(solver->positions());
    }
    report.seconds_rest = report.seconds_total - report.seconds_forces - report.seconds_solve;
    report.bytes = solver->bytes();
    report.energy_final = energy(problem, solver->positions(), solver->velocities()).total();
    return report;
}

}  // namespace

int run_baseline(int argc, const char* const* argv, const BaselineProgram& program) {
    return run_main(argc, argv, [&program](int count, const char* const* arguments) {
        CLI::App app(program.description);
        ProblemOptions problem_options;
        BaselineOptions options;
        SnapshotOptions snapshot_options;
        add_baseline_options(app, options, program);
        add_snapshot_options(app, snapshot_options);
        add_problem_options(app, problem_options);
        if (!parse_command_line(app, count, arguments)) return ExitCode::success;
        if (options.newton_tolerance > 0 && (options.linearisation != Linearisation::prediction ||
                                             options.rotation_interval != 1 || options.cg_tolerance == 0)) {
            throw Error(
                "--newton-tolerance: expected together with --linearise prediction, --cg-tolerance and "
                "--rotation-interval 1");
        }

        const Problem problem = make_problem(problem_options);
        Snapshots snapshots(snapshot_options, problem);
        const WorkerReport report = simulate(problem, options, program, snapshots);
        snapshots.write();
        std::cout << to_line(report) << std::endl;
        return ExitCode::success;
    });
}

ElementGroups group_elements(const mesh::TetMesh& mesh, int threads) {
    const auto tetrahedra = mesh.tetrahedra();
    std::vector<std::size_t> group_of(tetrahedra.size(), 0);
    std::size_t groups = 1;
    if (threads > 1) {
        std::vector<std::vector<std::size_t>> used(mesh.nodes().size());  // groups of the elements around a node
        for (std::size_t element = 0; element < tetrahedra.size(); ++element) {
            const auto taken = [&](std::size_t group) {
                return std::any_of(tetrahedra[element].begin(), tetrahedra[element].end(), [&](std::int32_t node) {
                    const auto& list = used[static_cast<std::size_t>(node)];
                    return std::find(list.begin(), list.end(), group) != list.end();
                });
            };
            while (taken(group_of[element])) ++group_of[element];
            groups = std::max(groups, group_of[element] + 1);
            for (const std::int32_t node : tetrahedra[element]) {
                used[static_cast<std::size_t>(node)].push_back(group_of[element]);
            }
        }
    }
    ElementGroups result;
    for (std::size_t group = 0; group < groups; ++group) {
        result.begins.push_back(result.elements.size());
        for (std::size_t element = 0; element < tetrahedra.size(); ++element) {
            if (group_of[element] == group) result.elements.push_back(static_cast<std::int32_t>(element));
        }
    }
    result.begins.push_back(result.elements.size());
    return result;
}

std::size_t MatrixGraph::place(std::int32_t node, std::int32_t column) const {
    const auto row = static_cast<std::size_t>(node);
    const auto first = columns.begin() + static_cast<std::ptrdiff_t>(begins[row]);
    const auto last = columns.begin() + static_cast<std::ptrdiff_t>(begins[row + 1]);
    return static_cast<std::size_t>(std::lower_bound(first, last, column) - first);
}

MatrixGraph matrix_graph(const mesh::TetMesh& mesh) {
    const mesh::NodeGraph neighbours = mesh::node_graph(mesh);
    MatrixGraph graph;
    for (std::int32_t node = 0; node < static_cast<std::int32_t>(neighbours.node_count()); ++node) {
        const auto others = neighbours.of(node);
        const auto middle = std::lower_bound(others.begin(), others.end(), node);
        graph.begins.push_back(graph.columns.size());
        graph.columns.insert(graph.columns.end(), others.begin(), middle);
        graph.columns.push_back(node);
        graph.columns.insert(graph.columns.end(), middle, others.end());
    }
    graph.begins.push_back(graph.columns.size());
    return graph;
}

}  // namespace lancet::experiments::bar
