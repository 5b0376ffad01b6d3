// The Bar of Jerabkova 2007, or any other mesh, solved by every method in a process of its own: time beside error.

#include <algorithm>
#include <cmath>
#include <iostream>
#include <thread>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "lancet/experiments/bar/errors.hpp"
#include "lancet/experiments/bar/pictures.hpp"
#include "lancet/experiments/bar/problem.hpp"
#include "lancet/experiments/bar/reference.hpp"
#include "lancet/experiments/bar/rows.hpp"
#include "lancet/experiments/bar/search.hpp"
#include "lancet/experiments/bar/settings.hpp"
#include "lancet/experiments/bar/workers.hpp"
#include "lancet/experiments/common/file.hpp"
#include "lancet/experiments/common/machine_limits.hpp"
#include "lancet/experiments/common/main.hpp"
#include "lancet/experiments/common/options.hpp"
#include "lancet/experiments/common/process.hpp"
#include "lancet/experiments/common/progress.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/kernels/isa/instruction_set.hpp"
#include "lancet/runtime/observe/machine_stamp.hpp"
#include "lancet/runtime/observe/machine_stamp_json.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"

namespace {

using namespace lancet;
using namespace lancet::experiments;
using namespace lancet::experiments::bar;

struct Options {
    ProblemOptions problem;
    SharedOptions shared;
    bool original = false;
    bool accurate = false;
    std::vector<std::string> operators;
    std::vector<std::string> methods;
    int repetitions = 3;
    bool no_errors = false;
    std::filesystem::path pictures;
    std::filesystem::path cache = default_cache();
};

void add_options(CLI::App& app, Options& options) {
    add_shared_options(app, options.shared, {.scalars = {"float", "mixed", "double"}});
    app.add_flag("--original", options.original, "Only the original setting: 10 iterations, no preconditioner");
    app.add_flag("--accurate", options.accurate, "Only what reaches an error of 0.5 % at t = 1 s");
    add_words(app, "--operator", options.operators, {"matrix-free", "edge-blocks", "block-rows"},
              "Operators of lancet");
    std::vector<std::string> methods;
    for (const Entry& entry : entries()) {
        if (std::find(methods.begin(), methods.end(), entry.method) == methods.end()) methods.push_back(entry.method);
    }
    add_words(app, "--method", options.methods, methods, "Only these methods");
    app.add_option("--repetitions", options.repetitions, "Runs of every row, interleaved")->check(CLI::Range(1, 1000));
    app.add_flag("--no-errors", options.no_errors, "Measure times only; converged solutions of large meshes are slow");
    app.add_option("--pvd", options.pictures, "Write the motion of every row to FOLDER, for ParaView")
        ->type_name("FOLDER");
    app.add_option("--cache", options.cache, "Folder where converged solutions are kept")->type_name("FOLDER");
    add_problem_options(app, options.problem);
}

/// The short run: a small Bar for 1 s, once.
void make_quick(Options& options, const CLI::App& app) {
    if (app.count("--mesh") + app.count("--cells") == 0) options.problem.cells = {20, 4, 4};
    if (app.count("--steps") == 0) {
        options.problem.steps = std::max(1, static_cast<int>(std::round(1 / options.problem.time_step)));
    }
    if (app.count("--repetitions") == 0) options.repetitions = 1;
}

bool asked_for(const Options& options, const Entry& entry) {
    if (!options.methods.empty() &&
        std::find(options.methods.begin(), options.methods.end(), entry.method) == options.methods.end()) {
        return false;
    }
    if (entry.setting == "accurate") return !options.no_errors && (options.accurate || !options.original);
    if (entry.setting == "default") return !options.accurate && !options.original;
    return options.original || !options.accurate;
}

/// What all parts of a run need.
struct Run {
    const Options& options;
    const Problem& problem;
    const Reference& reference;
    Progress& progress;
    std::filesystem::path folder;
};

std::vector<Job> all_jobs(const Run& run, const Choice& choice) {
    const bool can_search = !run.reference.times.empty() && run.reference.times.front() == 1.0;
    std::vector<Job> jobs;
    for (const Entry& entry : entries()) {
        if (!asked_for(run.options, entry)) continue;
        const std::vector<Job> plain = jobs_of(entry, entry.sequences.front().front(), choice, run.folder);
        const bool needs_errors = std::any_of(entry.sequences.begin(), entry.sequences.end(),
                                              [](const auto& sequence) { return sequence.size() > 1; });
        if (!needs_errors) {
            for (std::size_t i = 0; i < plain.size(); ++i) {
                std::vector<Job> ends;
                for (const auto& sequence : entry.sequences) {
                    ends.push_back(jobs_of(entry, sequence.front(), choice, run.folder)[i]);
                }
                jobs.push_back(fastest_of(ends, run.options.problem, run.problem, run.progress));
            }
            continue;
        }
        if (!can_search) {
            if (run.options.accurate) {
                throw Error("--accurate: the simulation has no step at t = 1 s, expected a time step that divides 1 s");
            }
            continue;
        }
        for (std::size_t i = 0; i < plain.size(); ++i) {
            jobs.push_back(search(entry, choice, i, run.options.problem, run.problem, run.reference.positions.front(),
                                  run.folder, run.progress));
        }
    }
    if (jobs.empty()) throw Error("nothing to measure: no method has the setting asked for");
    return jobs;
}

/// Positions at rest, found by the method of `job` itself.
std::vector<double> rest_of(const Run& run, const Job& job) {
    if (run.reference.positions_rest.empty()) return {};
    const ProblemOptions rest = to_rest(run.options.problem, run.problem);
    std::vector<std::vector<double>> snapshots;
    run.progress.show("to rest: " + job.label());
    run_worker(job, rest, {rest.steps * rest.time_step}, run.problem.mesh.nodes().size(), snapshots);
    return snapshots.front();
}

nlohmann::ordered_json describe_problem(const Options& options, const Problem& problem) {
    nlohmann::ordered_json json;
    json["nodes"] = problem.mesh.nodes().size();
    json["elements"] = problem.mesh.tetrahedra().size();
    json["fixed_nodes"] = problem.fixed_nodes.size();
    json["length"] = problem.length;
    json["options"] = problem_arguments(options.problem);
    json["notes"] = problem.notes;
    return json;
}

/// The schedulers to measure unless asked otherwise: all but the one that exists for tests.
std::vector<std::string> measured_schedulers() {
    std::vector<std::string> names;
    for (const runtime::SchedulerKind kind : runtime::available_schedulers()) {
        if (kind != runtime::SchedulerKind::threads) names.emplace_back(runtime::to_string(kind));
    }
    return names;
}

/// The thread counts to measure unless asked otherwise: one, and all the machine has.
std::vector<int> measured_threads() {
    const auto all = static_cast<int>(std::thread::hardware_concurrency());
    return all > 1 ? std::vector<int>{1, all} : std::vector<int>{1};
}

/// What one thread can do at most: what GFLOP/s and GB/s are to be compared with.
struct OneThread {
    double peak_gflops_float;  ///< multiply-adds of the active instruction set
    double peak_gflops_double;
    double memory_gbytes_per_s;  ///< reading 256 MiB
    double cache_gbytes_per_s;   ///< reading 1 MiB
};

OneThread measure_one_thread() {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    MachineLimits limits(*scheduler);
    constexpr double mebibyte = 1 << 20;
    return {.peak_gflops_float = limits.peak_gflops<float>(kernels::active_instruction_set()),
            .peak_gflops_double = limits.peak_gflops<double>(kernels::active_instruction_set()),
            .memory_gbytes_per_s = limits.read_gbytes_per_s(256 * mebibyte),
            .cache_gbytes_per_s = limits.read_gbytes_per_s(mebibyte)};
}

nlohmann::ordered_json machine(const Options& options, const OneThread& limits) {
    const int threads = options.shared.threads.empty() ? 1 : options.shared.threads.back();
    nlohmann::ordered_json json = runtime::machine_stamp("see rows", runtime::default_scheduler, threads);
    json["one_thread_limits"] = {{"peak_gflops_float", limits.peak_gflops_float},
                                 {"peak_gflops_double", limits.peak_gflops_double},
                                 {"memory_gbytes_per_s", limits.memory_gbytes_per_s},
                                 {"cache_gbytes_per_s", limits.cache_gbytes_per_s}};
    return json;
}

ExitCode body(int argc, const char* const* argv) {
    CLI::App app("The Bar: corotational tetrahedra by every method, time beside error");
    Options options;
    add_options(app, options);
    if (!parse_command_line(app, argc, argv)) return ExitCode::success;
    if (options.shared.quick) make_quick(options, app);
    if (options.accurate && options.no_errors) throw Error("--accurate and --no-errors: found both, expected one");
    const OneThread limits = measure_one_thread();
    const auto stamp = machine(options, limits);

    const Problem problem = make_problem(options.problem);
    for (const std::string& note : problem.notes) std::cerr << options.problem.mesh << ": " << note << '\n';
    const std::filesystem::path folder = this_program().parent_path();
    Progress progress;
    Reference reference;
    if (!options.no_errors) {
        const ReferenceChoice choice{.step_length = !options.shared.quick, .rest = !options.shared.quick};
        reference = make_reference(options.problem, problem, choice, folder, options.cache, progress);
    }
    const Run run{options, problem, reference, progress, folder};

    Choice choice;
    if (!options.shared.scalars.empty()) choice.scalars = options.shared.scalars;
    choice.threads = options.shared.threads.empty() ? measured_threads() : options.shared.threads;
    choice.schedulers = options.shared.schedulers;
    if (choice.schedulers.empty()) choice.schedulers = measured_schedulers();
    choice.instruction_sets = options.shared.instruction_sets;
    choice.operators = options.operators;
    const std::vector<Job> jobs = all_jobs(run, choice);
    const std::vector<JobResult> results =
        run_jobs(jobs, options.repetitions, options.problem, reference.times, problem.mesh.nodes().size(), progress);
    std::vector<Row> rows;
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        const Errors errors = errors_of(problem, reference, results[i].snapshots, rest_of(run, jobs[i]));
        rows.push_back(make_row(jobs[i], results[i].reports, errors, problem.time_step));
    }
    add_speedups(rows);
    if (!options.pictures.empty()) {
        for (const Row& row : rows) {
            const std::string name = picture_name(row.job, row.report.scalar);
            progress.show("pictures: " + name);
            write_pictures(row.job, options.problem, problem, options.pictures, name);
        }
    }
    const Table table = make_table(rows);
    progress.clear();

    table.print(std::cout);
    std::cout << "\nOne thread of this machine (" << kernels::to_string(kernels::active_instruction_set())
              << ") reaches " << format_number(limits.peak_gflops_float, 3) << " GFLOP/s in float, "
              << format_number(limits.peak_gflops_double, 3) << " in double, and reads "
              << format_number(limits.cache_gbytes_per_s, 3) << " GB/s from cache, "
              << format_number(limits.memory_gbytes_per_s, 3) << " from memory.\n";
    if (options.shared.csv) table.write_csv(*options.shared.csv);
    if (options.shared.json) {
        nlohmann::ordered_json document;
        document["machine"] = stamp;
        document["problem"] = describe_problem(options, problem);
        document["rows"] = table.to_json();
        write_json_file(*options.shared.json, document);
    }
    for (const Row& row : rows) {
        if (row.job.setting != "accurate" || (row.errors.t1 && *row.errors.t1 <= accurate_error_percent)) continue;
        const std::string miss =
            row.job.label() + " does not reach " + format_number(accurate_error_percent, 3) + " % at t = 1 s";
        // Any mesh may be too soft for its time step; who asks for accuracy gets a failure, others the row and this
        // note.
        if (options.accurate) throw CheckFailed(miss);
        std::cerr << "note: " << miss << '\n';
    }
    return ExitCode::success;
}

}  // namespace

int main(int argc, char** argv) {
    return run_main(argc, argv, body);
}
