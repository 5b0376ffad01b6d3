#include "lancet/experiments/scaling/settings.hpp"

#include <algorithm>

#include <CLI/CLI.hpp>

#include "lancet/experiments/bar/reference.hpp"
#include "lancet/experiments/scaling/problem.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/kernels/isa/instruction_set.hpp"
#include "lancet/runtime/observe/machine.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::experiments::scaling {
namespace {

using Words = std::vector<std::string>;

/// The schedulers of several threads that are compiled in, without the one that exists for tests.
Words parallel_schedulers() {
    Words names;
    for (const runtime::SchedulerKind kind : runtime::available_schedulers()) {
        if (kind == runtime::SchedulerKind::openmp || kind == runtime::SchedulerKind::tbb) {
            names.emplace_back(runtime::to_string(kind));
        }
    }
    return names;
}

/// The active instruction set, then the others that this machine executes.
Words executable_instruction_sets() {
    const auto active = kernels::active_instruction_set();
    Words names{std::string(kernels::to_string(active))};
    for (const kernels::InstructionSet set : kernels::compiled_instruction_sets()) {
        if (set != active && kernels::is_executable(set)) names.emplace_back(kernels::to_string(set));
    }
    return names;
}

/// 1, 2, 4, ... below the number of cores, and that number.
std::vector<int> counts_up_to(int cores) {
    std::vector<int> counts;
    for (int count = 1; count < cores; count *= 2) counts.push_back(count);
    counts.push_back(std::max(1, cores));
    return counts;
}

void complete(ScalingSettings& settings) {
    const bool is_quick = settings.shared.quick;
    if (settings.series.empty()) settings.series = series_names();
    if (settings.benchmarks.empty()) settings.benchmarks = benchmark_names();

    settings.threads = settings.shared.threads;
    if (settings.threads.empty()) settings.threads = counts_up_to(runtime::cores_allowed());
    if (std::ranges::find(settings.threads, 1) == settings.threads.end()) settings.threads.push_back(1);
    std::ranges::sort(settings.threads);

    const Words available = parallel_schedulers();
    settings.schedulers = settings.shared.schedulers.empty() ? available : settings.shared.schedulers;
    std::erase(settings.schedulers, "serial");
    for (const std::string& name : settings.schedulers) {
        if (std::ranges::find(available, name) == available.end()) {
            throw Error("--scheduler: '" + name + "' is not compiled in");
        }
    }

    settings.varies_one_by_one = settings.shared.instruction_sets.empty() && settings.shared.scalars.empty() &&
                                 settings.operators.empty() && settings.scatters.empty();
    const bool is_fixed = !settings.varies_one_by_one;
    const auto fill = [is_fixed](Words& target, const Words& given, const Words& all) {
        if (!given.empty()) {
            target = given;
        } else {
            target = is_fixed ? Words{all.front()} : all;
        }
    };
    fill(settings.instruction_sets, settings.shared.instruction_sets, executable_instruction_sets());
    fill(settings.scalars, settings.shared.scalars, {"float", "mixed", "double"});
    fill(settings.operators, Words(settings.operators), {"edge-blocks", "matrix-free", "block-rows"});
    fill(settings.scatters, Words(settings.scatters), {"private-copies", "coloring", "node-gather"});
    for (const std::string& name : settings.instruction_sets) {
        kernels::require(kernels::instruction_set_from_string(name));
    }
    if (settings.steps == 0) settings.steps = is_quick ? 25 : 50;
    if (settings.extra_rounds < 0) settings.extra_rounds = is_quick ? 0 : 3;
    if (settings.repetitions == 0) settings.repetitions = is_quick ? 1 : 5;
}

}  // namespace

const std::vector<std::string>& series_names() {
    static const Words names{"strong", "weak", "variants", "thesis"};
    return names;
}

std::vector<int> default_elements(const std::string& benchmark, bool is_quick) {
    if (is_quick) return {benchmark == "bar" ? 1600 : 2592};
    if (benchmark == "bar") return {own_elements(benchmark), 8 * own_elements(benchmark)};
    return {own_elements(benchmark)};
}

std::optional<ScalingSettings> parse_settings(int argc, const char* const* argv) {
    ScalingSettings settings;
    settings.cache = bar::default_cache();
    CLI::App app("Scaling: threads, schedulers, instruction sets and sizes, with the machine's own load");
    add_shared_options(app, settings.shared, {.scalars = {"float", "mixed", "double"}});
    add_words(app, "--series", settings.series, series_names(), "Only these series");
    add_words(app, "--problem", settings.benchmarks, benchmark_names(), "Benchmarks");
    add_words(app, "--operator", settings.operators, {"edge-blocks", "matrix-free", "block-rows"},
              "How the step matrix is kept");
    add_words(app, "--scatter", settings.scatters, {"private-copies", "coloring", "node-gather"},
              "How elements add to nodes");
    app.add_option_function<std::string>(
           "--elements",
           [&settings](const std::string& text) { settings.elements = parse_counts("--elements", text, 100); },
           "Sizes, a list of numbers of elements; series weak has the smallest for each thread, variants is of it too")
        ->type_name("LIST");
    app.add_option("--setting", settings.setting,
                   "default (10 iterations with the coarse space, linearised at the prediction) or original (10 plain "
                   "iterations, rotations every 5th step)")
        ->check(CLI::IsMember({"default", "original"}));
    app.add_option("--steps", settings.steps, "Steps of 40 ms of each run; 50, or 25 with --quick")
        ->check(CLI::Range(1, 1'000'000));
    app.add_option("--repetitions", settings.repetitions, "Runs of every row, interleaved; 5, or 1 with --quick")
        ->check(CLI::Range(1, 1000));
    app.add_option("--extra-rounds", settings.extra_rounds,
                   "More rounds, at most, for rows that the machine's load disturbed; 3, or none with --quick")
        ->check(CLI::Range(0, 1000));
    app.add_flag("--pin", settings.pin,
                 "Hold every thread of every scheduler to a core: each asks for it (sched_setaffinity) in a loop that "
                 "waits for all of them");
    app.add_flag("--no-errors", settings.no_errors, "Measure times only; converged solutions of large meshes are slow");
    app.add_option("--plot", settings.plot, "Draw pictures to FOLDER, as SVG and PNG")->type_name("FOLDER");
    app.add_option("--cache", settings.cache, "Folder where converged solutions are kept")->type_name("FOLDER");
    if (!parse_command_line(app, argc, argv)) return std::nullopt;
    complete(settings);
    return settings;
}

}  // namespace lancet::experiments::scaling
