#include "lancet/experiments/scheduler/settings.hpp"

#include <algorithm>
#include <cmath>

#include <CLI/CLI.hpp>

#include "lancet/experiments/common/table.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::scheduler {
namespace {

/// Halved and doubled cells of the Bar.
constexpr std::array<std::pair<int, int>, 4> sizes{{{1600, 4}, {12800, 8}, {102400, 16}, {819200, 32}}};

std::vector<std::string> size_words() {
    std::vector<std::string> words;
    for (const auto& [elements, cells] : sizes) words.push_back(std::to_string(elements));
    return words;
}

}  // namespace

WorkerJob job_for(int elements, const SchedulerSettings& settings) {
    WorkerJob job{.problem = {.cells = {}, .settings = settings.body}};
    const auto* size = std::ranges::find(sizes, elements, &std::pair<int, int>::first);
    if (size == sizes.end()) throw Error("there is no bar of " + std::to_string(elements) + " elements");
    job.problem.cells = {5 * size->second, size->second, size->second};
    const bool is_quick = settings.shared.quick;
    const bool is_small = elements <= 12800;
    job.runs = is_quick || !is_small ? 1 : 2;
    job.steps = is_quick ? 25 : is_small ? 125 : 40;
    job.block = is_quick ? 5 : elements <= 1600 ? 20 : is_small ? 10 : 5;
    // Where frames are rarer than steps: three frames and twenty collisions.
    constexpr double time_between_frames = 1.0 / 30;
    const double time_step = settings.body.time_step;
    if (time_step < time_between_frames) {
        const auto up = [&job](int steps) { return (steps + job.window - 1) / job.window * job.window; };
        job.window = static_cast<int>(std::ceil(3 * time_between_frames / time_step - 1e-9));
        job.block = up(job.block);
        job.steps = up(job.steps);
    }
    return job;
}

std::optional<SchedulerSettings> parse_settings(int argc, const char* const* argv) {
    SchedulerSettings settings;
    CLI::App app("Scheduler: flow graph, parallel loops and OpenMP tasks on the same step");
    add_shared_options(app, settings.shared, {.scalars = {"float", "mixed", "double"}});
    std::string all;
    for (const std::string& word : size_words()) all += (all.empty() ? "" : ", ") + word;
    app.add_option_function<std::string>(
           "--elements",
           [&settings](const std::string& text) {
               for (const std::string& word : parse_words("--elements", text, size_words())) {
                   settings.elements.push_back(std::stoi(word));
               }
           },
           "Bars of so many elements, a list out of: " + all)
        ->type_name("LIST");
    app.add_option("--time-step", settings.body.time_step,
                   "Time step in s; shorter than the 0.033 s between frames, some steps have none")
        ->check(CLI::Range(1e-4, 1.0))
        ->capture_default_str();
    app.add_option("--repetitions", settings.repetitions, "Processes for each row; 5, or 3 with --quick")
        ->check(CLI::Range(1, 1000));
    bool is_worker = false;
    app.add_flag("--worker", is_worker, "Measure one bar, scheduler and number of threads; for the program itself")
        ->group("");
    if (!parse_command_line(app, argc, argv)) return std::nullopt;

    const bool is_quick = settings.shared.quick;
    if (settings.elements.empty())
        settings.elements = is_quick ? std::vector{1600, 12800} : std::vector{1600, 12800, 102400};
    std::ranges::sort(settings.elements);
    if (settings.repetitions == 0) settings.repetitions = is_quick ? 3 : 5;
    settings.threads = settings.shared.threads.empty() ? std::vector{1, 2} : settings.shared.threads;
    const auto available = runtime::available_schedulers();
    for (const std::string& name : settings.shared.schedulers.empty()
                                       ? std::vector<std::string>{"serial", "tbb", "openmp"}
                                       : settings.shared.schedulers) {
        const auto kind = runtime::scheduler_from_string(name);
        if (std::ranges::find(available, kind) != available.end()) {
            settings.kinds.push_back(kind);
        } else if (!settings.shared.schedulers.empty()) {
            throw Error("--scheduler: '" + name + "' is not compiled in");
        }
    }
    const bool has_serial_only =
        std::ranges::all_of(settings.kinds, [](auto kind) { return kind == runtime::SchedulerKind::serial; });
    if (has_serial_only && std::ranges::find(settings.threads, 1) == settings.threads.end()) {
        throw Error("--threads: the serial scheduler has one thread, expected 1 among them");
    }
    if (const std::string isa = only(settings.shared.instruction_sets, std::string(), "--isa"); !isa.empty()) {
        settings.body.instruction_set = kernels::instruction_set_from_string(isa);
        kernels::require(settings.body.instruction_set);
    }
    if (const std::string scalar = only(settings.shared.scalars, std::string(), "--scalar"); !scalar.empty()) {
        settings.body.scalar = runtime::scalar_mode_from_string(scalar);
    }
    if (is_worker) {
        settings.work = job_for(settings.elements.front(), settings);
        settings.work->kind = settings.kinds.at(0);
        settings.work->threads = settings.threads.at(0);
    }
    return settings;
}

std::vector<std::string> worker_arguments(int elements, runtime::SchedulerKind kind, int threads,
                                          const SchedulerSettings& settings) {
    std::vector<std::string> arguments{"--worker",
                                       "--elements=" + std::to_string(elements),
                                       "--time-step=" + format_exact(settings.body.time_step),
                                       "--scheduler=" + std::string(to_string(kind)),
                                       "--threads=" + std::to_string(threads),
                                       "--isa=" + std::string(kernels::to_string(settings.body.instruction_set)),
                                       "--scalar=" + std::string(to_string(settings.body.scalar))};
    if (settings.shared.quick) arguments.emplace_back("--quick");
    return arguments;
}

}  // namespace lancet::experiments::scheduler
