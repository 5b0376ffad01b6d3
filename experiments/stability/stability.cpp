// Stress tests: what survives and what does not, with a seed for everything that does not.

#include <algorithm>
#include <iostream>
#include <thread>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "lancet/experiments/common/file.hpp"
#include "lancet/experiments/common/main.hpp"
#include "lancet/experiments/common/options.hpp"
#include "lancet/experiments/common/process.hpp"
#include "lancet/experiments/common/progress.hpp"
#include "lancet/experiments/common/stop_signal.hpp"
#include "lancet/experiments/stability/case.hpp"
#include "lancet/experiments/stability/report.hpp"
#include "lancet/experiments/stability/workers.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/kernels/isa/instruction_set.hpp"
#include "lancet/runtime/observe/machine_stamp.hpp"
#include "lancet/runtime/observe/machine_stamp_json.hpp"

namespace {

using namespace lancet;
using namespace lancet::experiments;
using namespace lancet::experiments::stability;

struct Options {
    SharedOptions shared;
    Selection selection;
    std::string case_name;
    std::string worker;  ///< "begin,end" of the cases that this process runs for another
    double limit = 1200;
};

void add_options(CLI::App& app, Options& options) {
    add_shared_options(app, options.shared, {.scalars = {"float", "mixed", "double"}});
    std::vector<std::string> names;
    std::string list;
    for (const Category& category : categories()) {
        names.push_back(category.name);
        list += (list.empty() ? "" : ", ") + category.name;
    }
    app.add_option_function<std::string>(
           "--category",
           [&options, names](const std::string& text) {
               options.selection.categories = parse_words("--category", text, names);
           },
           "Only these categories, a list out of: " + list)
        ->type_name("LIST");
    app.add_option("--cases", options.selection.cases, "So many cases of each category, instead of its own number")
        ->check(CLI::Range(1, 10000000));
    app.add_option("--seed", options.selection.seed, "Of the first case of each category, or of the one of --case");
    app.add_option("--case", options.case_name, "Run one case again, by its name and --seed")->type_name("NAME");
    app.add_option("--limit", options.limit, "Seconds that 20 cases may take before they count as not ending")
        ->check(CLI::Range(1.0, 1e6));
    app.add_option("--worker", options.worker, "Run these cases for another process")->group("");
}

std::unique_ptr<runtime::Scheduler> scheduler_of(const SharedOptions& shared) {
    const std::string name = only(shared.schedulers, std::string(), "--scheduler");
    const auto kind = name.empty() ? runtime::SchedulerKind::serial : runtime::scheduler_from_string(name);
    return runtime::make_scheduler(kind, kind == runtime::SchedulerKind::serial ? 1 : 2);
}

ExitCode run_again(const Options& options) {
    const Case one = case_named(options.case_name, options.selection.seed);
    const auto scheduler = scheduler_of(options.shared);
    const Verdict verdict = run_case(one, *scheduler);
    std::cout << verdict_json(verdict).dump(2) << '\n' << categories()[one.category].criterion << '\n';
    if (!verdict.survived) throw CheckFailed(one.name() + ", seed " + std::to_string(one.seed) + ": " + verdict.reason);
    return ExitCode::success;
}

int processes_of(const SharedOptions& shared) {
    if (shared.threads.size() > 1) throw Error("--threads: expected one number of processes at the same time");
    if (!shared.threads.empty()) return shared.threads.front();
    return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

ExitCode body(int argc, const char* const* argv) {
    CLI::App app(
        "Stress tests: slivers, random cut sequences, lost shapes, extreme materials and bad input. Exit code 1 where "
        "something fails that the method is made for, 3 when SIGINT or SIGTERM ends it: with what there is by then");
    Options options;
    add_options(app, options);
    if (!parse_command_line(app, argc, argv)) return ExitCode::success;
    options.selection.quick = options.shared.quick;
    options.selection.scalars = options.shared.scalars;
    const std::string instruction_set = only(options.shared.instruction_sets, std::string(), "--isa");
    if (!instruction_set.empty()) kernels::require(kernels::instruction_set_from_string(instruction_set));
    if (!options.case_name.empty()) {
        if (!instruction_set.empty()) throw Error("--isa: with --case, set the environment variable LANCET_ISA");
        return run_again(options);
    }
    const std::vector<Case> cases = cases_of(options.selection);
    if (!options.worker.empty()) {
        const std::vector<int> range = parse_counts("--worker", options.worker, 0);
        if (range.size() != 2 || range[0] > range[1] || static_cast<std::size_t>(range[1]) > cases.size()) {
            throw Error("--worker: expected the first case and the one behind the last");
        }
        const auto scheduler = scheduler_of(options.shared);
        work(cases, static_cast<std::size_t>(range[0]), static_cast<std::size_t>(range[1]), *scheduler, std::cout);
        return ExitCode::success;
    }
    scheduler_of(options.shared);  // refused here if it is not compiled in

    const int processes = processes_of(options.shared);
    const std::string_view set =
        instruction_set.empty() ? kernels::to_string(kernels::active_instruction_set()) : instruction_set;
    const auto write_json = [&](const std::vector<Outcome>& outcomes, bool is_complete) {
        if (!options.shared.json) return;
        nlohmann::ordered_json document;
        document["machine"] = runtime::machine_stamp(set, runtime::SchedulerKind::serial, processes);
        document["seed"] = options.selection.seed;
        document["complete"] = is_complete;
        document["cases"] = cases.size();
        document["run"] = outcomes.size();
        document.update(report_json(outcomes));
        write_json_file(*options.shared.json, document);
    };
    const StopOnSignal signals;
    const WorkerSettings settings{
        .program = this_program(),
        .arguments = {argv + 1, argv + argc},
        .instruction_set = instruction_set,
        .processes = processes,
        .seconds = options.limit,
        .stop = signals.token(),
        .interim = [&](const std::vector<Outcome>& outcomes) { write_json(outcomes, false); }};
    Progress progress;
    const std::vector<Outcome> outcomes = run_cases(cases, settings, progress);
    progress.clear();
    print_report(std::cout, outcomes);
    if (options.shared.csv) survival_table(outcomes).write_csv(*options.shared.csv);
    write_json(outcomes, outcomes.size() == cases.size());
    if (outcomes.size() < cases.size()) {
        std::cerr << "stability: stopped after " << outcomes.size() << " of " << cases.size() << " cases\n";
        return ExitCode::stopped;
    }
    const std::size_t failures = promised_failures(outcomes);
    if (failures > 0) throw CheckFailed(std::to_string(failures) + " cases failed that should survive");
    return ExitCode::success;
}

}  // namespace

int main(int argc, char** argv) {
    return run_main(argc, argv, body);
}
