// Run time against error: every problem by every method and setting, with what the rows mean: the Pareto front, advice,
// what dominates the error, and what failed.

#include <algorithm>
#include <iostream>
#include <set>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "lancet/experiments/common/file.hpp"
#include "lancet/experiments/common/main.hpp"
#include "lancet/experiments/common/options.hpp"
#include "lancet/experiments/common/process.hpp"
#include "lancet/experiments/common/progress.hpp"
#include "lancet/experiments/precision/advice.hpp"
#include "lancet/experiments/precision/diagram.hpp"
#include "lancet/experiments/precision/dynamics.hpp"
#include "lancet/experiments/precision/measure.hpp"
#include "lancet/experiments/precision/report.hpp"
#include "lancet/experiments/precision/statics.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/kernels/isa/instruction_set.hpp"
#include "lancet/runtime/observe/machine_stamp.hpp"
#include "lancet/runtime/observe/machine_stamp_json.hpp"

namespace {

using namespace lancet;
using namespace lancet::experiments;
using namespace lancet::experiments::precision;

const std::vector<std::string>& problem_names() {
    static const std::vector<std::string> names{"bar-static", "bar-dynamic", "cantilever", "beam", "tumbling"};
    return names;
}

struct Options {
    SharedOptions shared;
    std::vector<std::string> problems;
    Effort effort;
    std::filesystem::path plot;
};

void add_options(CLI::App& app, Options& options) {
    add_shared_options(app, options.shared, {.scalars = {"float", "mixed", "double"}});
    app.add_option_function<std::string>(
           "--problem",
           [&options](const std::string& text) { options.problems = parse_words("--problem", text, problem_names()); },
           "Only these problems, a list out of: bar-static, bar-dynamic, cantilever, beam, tumbling")
        ->type_name("LIST");
    app.add_option("--repetitions", options.effort.repetitions, "Runs of every row, interleaved; 3, or 1 with --quick")
        ->check(CLI::Range(1, 1000));
    app.add_option("--limit", options.effort.longest_seconds, "Omit runs that would take longer than so many seconds")
        ->check(CLI::Range(1e-3, 1e6));
    app.add_option("--plot", options.plot, "Draw diagrams to FOLDER, as SVG and PNG")->type_name("FOLDER");
}

Choice make_choice(const SharedOptions& shared) {
    Choice choice;
    choice.quick = shared.quick;
    if (!shared.scalars.empty()) choice.scalars = shared.scalars;
    if (!shared.threads.empty()) choice.threads = shared.threads;
    choice.schedulers = shared.schedulers;
    if (choice.schedulers.empty()) {
        const bool is_serial = choice.threads == std::vector<int>{1};
        choice.schedulers = {std::string(is_serial ? "serial" : runtime::to_string(runtime::default_scheduler))};
    }
    if (choice.schedulers == std::vector<std::string>{"serial"} &&
        std::find(choice.threads.begin(), choice.threads.end(), 1) == choice.threads.end()) {
        throw Error("--threads: the serial scheduler has one thread, expected 1 among the thread counts");
    }
    for (const std::string& name : choice.schedulers) {
        runtime::make_scheduler(runtime::scheduler_from_string(name), 1);  // refused here if it is not compiled in
    }
    choice.instruction_sets = shared.instruction_sets;
    if (choice.instruction_sets.empty()) {
        choice.instruction_sets.emplace_back(kernels::to_string(kernels::active_instruction_set()));
    }
    for (const std::string& name : choice.instruction_sets)
        kernels::require(kernels::instruction_set_from_string(name));
    choice.workers = this_program().parent_path();
    choice.bar_workers = choice.workers / LANCET_BAR_FOLDER;
    return choice;
}

/// All that a run of the program finds.
struct Findings {
    Results results;
    std::vector<BudgetLine> budget;
    std::vector<Comparison> comparisons;
    std::vector<OwnReference> references;
};

void compare_published(const StaticProblem& problem, const StaticReference& reference, Findings& findings) {
    const auto axis = static_cast<std::size_t>(problem.judged_axis);
    findings.comparisons.push_back({problem.problem, problem.variant, "deflection of the tip", *problem.tip[axis],
                                    reference.tip[axis], reference.tip_extrapolated[axis],
                                    published_difference_percent(problem, reference.tip_extrapolated),
                                    problem.source_percent, problem.source});
}

void study_statics(const StaticProblem& problem, const Options& options, const Choice& choice, Progress& progress,
                   Findings& findings) {
    const StaticReference reference = make_static_reference(problem, choice, progress);
    compare_published(problem, reference, findings);
    const auto cells = problem.box(reference.level).cells;
    findings.references.push_back({problem.problem, problem.variant,
                                   "double, " + std::to_string(cells[0]) + "x" + std::to_string(cells[1]) + "x" +
                                       std::to_string(cells[2]) + " cells, extrapolated in the mesh",
                                   reference.own_percent});
    measure(static_study(problem, reference, choice), options.effort, progress, findings.results);
    const StaticBudget parts = static_budget(problem, reference, choice, progress);
    BudgetLine line{.problem = problem.problem,
                    .variant = problem.variant,
                    .setting = parts.setting,
                    .time_step = {},
                    .linearisation = {},
                    .mesh = parts.mesh,
                    .solve = parts.solve,
                    .scalar = parts.scalar,
                    .total = parts.total};
    findings.budget.push_back(line);
}

void study_dynamics(const DynamicProblem& problem, const Options& options, const Choice& choice, Progress& progress,
                    Findings& findings) {
    const DynamicReference reference = make_dynamic_reference(problem, choice, progress);
    findings.references.push_back({problem.problem, "",
                                   "double, same mesh, central differences of " +
                                       format_number(problem.reference_step / 2, 3) +
                                       " s, extrapolated in the time step",
                                   reference.own_percent});
    measure(dynamic_study(problem, reference, choice), options.effort, progress, findings.results);
    findings.budget.push_back(dynamic_budget(problem, reference, choice, progress));
}

/// Calls `function` with the rows of each problem and variant, which follow each other.
void for_each_problem(std::span<const Row> rows, const auto& function) {
    for (std::size_t begin = 0; begin < rows.size();) {
        std::size_t end = begin;
        while (end < rows.size() && rows[end].problem == rows[begin].problem &&
               rows[end].variant == rows[begin].variant) {
            ++end;
        }
        function(rows.subspan(begin, end - begin));
        begin = end;
    }
}

std::string title(const Row& row) {
    return row.problem + (row.variant.empty() ? "" : ", " + row.variant);
}

void print(const Findings& findings, const std::vector<Advice>& advice) {
    const std::span<const Row> rows = findings.results.rows;
    for_each_problem(rows, [](std::span<const Row> part) {
        std::cout << title(part.front()) << " (* on the Pareto front)\n";
        make_printed_table(part).print(std::cout);
        std::cout << '\n';
    });
    std::cout
        << "Times are medians; range: slowest less fastest run, in percent of the median, missing for a single run.\n"
           "Errors are against the references and published values below: displacements in the L2 norm, stresses in "
           "the energy norm, "
           "and the quantity of interest.\n"
           "In dynamics they are those of time stepping alone: the reference is on the same mesh. What the mesh costs "
           "stands below.\n"
           "Extrapolated displacements are those of the coarser of two meshes: better at its nodes, not between "
           "them. The baseline has none, though it could.\n\n";
    std::cout << "For an error of so much use\n";
    make_advice_table(advice, rows).print(std::cout);
    std::cout << "\nWhat the error is made of (L2 norm)\n";
    make_budget_table(findings.budget).print(std::cout);
    if (!findings.comparisons.empty()) {
        std::cout << "\nPublished values\n";
        make_comparison_table(findings.comparisons).print(std::cout);
    }
    std::cout << '\n';
    make_reference_table(findings.references).print(std::cout);
    std::cout << "\nOmissions" << (findings.results.omissions.empty() ? ": none\n" : "\n");
    if (!findings.results.omissions.empty()) make_omission_table(findings.results.omissions).print(std::cout);
}

nlohmann::ordered_json to_json(const Findings& findings, const std::vector<Advice>& advice, const Choice& choice) {
    nlohmann::ordered_json document;
    document["machine"] =
        runtime::machine_stamp(choice.instruction_sets.front(),
                               runtime::scheduler_from_string(choice.schedulers.front()), choice.threads.front());
    document["rows"] = rows_json(findings.results.rows);
    document["pareto"] = pareto_json(findings.results.rows);
    document["omissions"] = make_omission_table(findings.results.omissions).to_json();
    document["advice"] = make_advice_table(advice, findings.results.rows).to_json();
    document["budget"] = make_budget_table(findings.budget).to_json();
    document["published"] = make_comparison_table(findings.comparisons).to_json();
    document["references"] = make_reference_table(findings.references).to_json();
    return document;
}

void plot(std::span<const Row> rows, const std::filesystem::path& folder) {
    std::set<std::string> complaints;
    for_each_problem(rows, [&](std::span<const Row> part) {
        std::string name = part.front().problem + (part.front().variant.empty() ? "" : "-" + part.front().variant);
        std::erase_if(name, [](char c) { return c == ',' || c == '.'; });
        std::replace(name.begin(), name.end(), ' ', '-');
        complaints.insert(draw(part, Shown::judged, title(part.front()), folder, name));
        if (part.front().solution.drift_energy) {
            complaints.insert(draw(part, Shown::quantity,
                                   title(part.front()) + ": drift of energy and angular momentum", folder,
                                   name + "-drift"));
        }
    });
    complaints.erase("");
    for (const std::string& complaint : complaints) {
        std::cerr << "no pictures: " << complaint << "; " << folder.string()
                  << " has the data and the scripts, and the Debian package gnuplot-nox draws them\n";
    }
}

/// The reference solutions must come to what others found; else every error here would be one of ours.
void check(const Findings& findings, bool quick) {
    for (const Comparison& one : findings.comparisons) {
        const double allowed = one.trusted_percent + (quick ? 3.0 : 1.0);
        if (one.difference_percent <= allowed) continue;
        throw CheckFailed(one.problem + " " + one.variant + ": the " + one.quantity + " is " +
                          format_number(one.difference_percent, 3) + " % from the published one, expected at most " +
                          format_number(allowed, 3) + " %");
    }
}

ExitCode body(int argc, const char* const* argv) {
    CLI::App app("Run time against error: statics and dynamics by every method, on one diagram with a baseline");
    Options options;
    add_options(app, options);
    if (!parse_command_line(app, argc, argv)) return ExitCode::success;
    if (options.shared.quick && app.count("--repetitions") == 0) options.effort.repetitions = 1;
    Choice choice = make_choice(options.shared);
    choice.longest_seconds = options.effort.longest_seconds;
    const auto asked_for = [&](const std::string& name) {
        const auto& list = options.problems;
        return list.empty() || std::find(list.begin(), list.end(), name) != list.end();
    };

    Progress progress;
    Findings findings;
    for (const StaticProblem& problem : static_problems()) {
        if (!asked_for(problem.problem) || (options.shared.quick && !problem.is_quick)) continue;
        study_statics(problem, options, choice, progress, findings);
    }
    for (const DynamicProblem& problem : dynamic_problems(options.shared.quick)) {
        if (asked_for(problem.problem)) study_dynamics(problem, options, choice, progress, findings);
    }
    progress.clear();
    const std::vector<Row>& rows = findings.results.rows;
    const std::vector<Advice> advice = give_advice(rows);
    print(findings, advice);
    if (options.shared.csv) make_table(rows).write_csv(*options.shared.csv);
    if (options.shared.json) write_json_file(*options.shared.json, to_json(findings, advice, choice));
    if (!options.plot.empty()) plot(rows, options.plot);
    check(findings, options.shared.quick);
    return ExitCode::success;
}

}  // namespace

int main(int argc, char** argv) {
    return run_main(argc, argv, body);
}
