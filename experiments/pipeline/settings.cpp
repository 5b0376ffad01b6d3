#include "lancet/experiments/pipeline/settings.hpp"

#include <CLI/CLI.hpp>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/observe/machine.hpp"

namespace lancet::experiments::pipeline {

std::optional<PipelineSettings> parse_settings(int argc, const char* const* argv) {
    PipelineSettings settings;
    CLI::App app("Pipeline: an interactive scene in real time, with its rates, deadlines and latencies");
    add_shared_options(app, settings.shared, {.schedulers = {"serial", "openmp", "tbb", "threads"}});
    std::optional<double> seconds;
    std::string size;
    bool is_unpaced = false, is_in_order = false, is_whole = false;
    app.add_option("--scene", settings.scene, "bar (12,800 elements) or organ (7,200)")
        ->check(CLI::IsMember({"bar", "organ"}));
    app.add_option("--seconds", seconds, "Simulated time; 60, or 4 with --quick")->check(CLI::Range(0.1, 1e5));
    app.add_option("--step", settings.time_step, "Time step of the world, in seconds")->check(CLI::Range(1e-4, 0.1));
    app.add_option("--frame-rate", settings.frame_rate, "Frames per second of simulated time")
        ->check(CLI::Range(0.1, 1000.0));
    app.add_option("--collision-rate", settings.collision_rate, "Hz")->check(CLI::Range(1.0, 10000.0));
    app.add_option("--force-rate", settings.force_rate, "Hz, of the device that moves the tool and feels")
        ->check(CLI::Range(1.0, 10000.0));
    app.add_flag("--unpaced", is_unpaced, "As fast as it goes, the tool's path replayed exactly; no deadlines");
    app.add_flag("--in-order", is_in_order, "Surfaces, frames and collision after the solve, not beside it");
    app.add_flag("--no-cut", is_whole, "The tool cuts nothing");
    app.add_option("--path", settings.path, "Tool path to play, lines of \"time x y z w x y z action\"")
        ->type_name("FILE");
    app.add_option("--record", settings.record, "Write the tool's samples to FILE, to be played again")
        ->type_name("FILE");
    app.add_option("--trace", settings.trace, "Write what ran when, for ui.perfetto.dev")->type_name("FILE");
    app.add_option("--dot", settings.dot, "Write the graph of a step for Graphviz")->type_name("FILE");
    app.add_option("--frames", settings.frames, "Write frames to FOLDER: PNG pictures, and frames.pvd for ParaView")
        ->type_name("FOLDER");
    app.add_option("--size", size, "Of the pictures; default 480x270")->type_name("WIDTHxHEIGHT");
    app.add_option("--soak", settings.soak, "Instead: so many simulated minutes of random input, cuts and resets")
        ->check(CLI::Range(0.01, 1e4));
    app.add_option("--seed", settings.seed, "Of the random input");
    if (!parse_command_line(app, argc, argv)) return std::nullopt;

    settings.seconds = seconds.value_or(settings.shared.quick ? 4 : 60);
    settings.is_paced = !is_unpaced;
    settings.overlaps = !is_in_order;
    settings.cuts = !is_whole;
    if (!size.empty()) {
        char rest = 0;
        if (std::sscanf(size.c_str(), "%dx%d%c", &settings.width, &settings.height, &rest) != 2 || settings.width < 1 ||
            settings.height < 1 || settings.width > 8192 || settings.height > 8192) {
            throw Error("--size: '" + size + "' is no size, expected such as 480x270");
        }
    }
    settings.threads = only(settings.shared.threads, runtime::cores_allowed(), "--threads");
    const std::string scheduler(settings.threads == 1 ? "serial" : runtime::to_string(runtime::default_scheduler));
    settings.scheduler = runtime::scheduler_from_string(only(settings.shared.schedulers, scheduler, "--scheduler"));
    if (settings.scheduler == runtime::SchedulerKind::serial) settings.threads = 1;
    if (!settings.shared.instruction_sets.empty()) {
        settings.instruction_set =
            kernels::instruction_set_from_string(only(settings.shared.instruction_sets, std::string(), "--isa"));
        kernels::require(settings.instruction_set);
    }
    if (settings.shared.scalars.size() > 0) throw Error("--scalar: this experiment runs in float");
    return settings;
}

}  // namespace lancet::experiments::pipeline
