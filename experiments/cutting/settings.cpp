#include "lancet/experiments/cutting/settings.hpp"

#include <algorithm>

#include <CLI/CLI.hpp>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/solve/operator.hpp"

namespace lancet::experiments::cutting {

const std::vector<std::string>& scene_names() {
    static const std::vector<std::string> names{"dissected-beam", "organ",       "scalpel",     "cost",
                                                "beam-case1",     "beam-case2T", "beam-case3T", "fraction-floor"};
    return names;
}

std::optional<CuttingSettings> parse_settings(int argc, const char* const* argv) {
    CuttingSettings settings;
    CLI::App app("Cutting: what a cut costs, what it gets wrong, and what it looks like");
    add_shared_options(app, settings.shared, {.scalars = {"float", "mixed", "double"}});
    const std::vector<std::string> operators{"edge-blocks", "matrix-free", "block-rows"};
    add_words(app, "--scene", settings.scenes, scene_names(), "Only these scenes");
    add_words(app, "--operator", settings.operators, operators, "How the step matrix is kept");
    std::filesystem::path mesh;
    std::optional<double> scale;
    app.add_option("--mesh", mesh, "Tetrahedral mesh of the scene organ; default: a generated one")->type_name("FILE");
    app.add_option("--mesh-scale", scale, "Factor on its coordinates, to get metres; default: 0.2 m long");
    app.add_option("--levels", settings.levels, "Meshes of the scenes beam-case...; 3, or 1 with --quick")
        ->check(CLI::Range(1, 6));
    app.add_option("--repetitions", settings.repetitions, "Runs of everything that is timed; 3, or 1 with --quick")
        ->check(CLI::Range(1, 1000));
    app.add_option("--pvd", settings.pvd, "Write frames for ParaView to FOLDER")->type_name("FOLDER");
    app.add_option("--plot", settings.plot, "Draw pictures to FOLDER, as PNG")->type_name("FOLDER");
    if (!parse_command_line(app, argc, argv)) return std::nullopt;

    const bool is_quick = settings.shared.quick;
    if (settings.scenes.empty()) settings.scenes = scene_names();
    if (settings.operators.empty()) settings.operators = is_quick ? std::vector{operators.front()} : operators;
    settings.scalars = settings.shared.scalars;
    if (settings.scalars.empty()) settings.scalars = {"float", "double"};
    if (settings.levels == 0) settings.levels = is_quick ? 1 : 3;
    if (settings.repetitions == 0) settings.repetitions = is_quick ? 1 : 3;
    if (!mesh.empty()) settings.organ = OrganFile{mesh, scale};
    if (scale && mesh.empty()) throw Error("--mesh-scale: there is no --mesh to scale");
    settings.threads = only(settings.shared.threads, 1, "--threads");
    const std::string scheduler(settings.threads == 1 ? "serial" : runtime::to_string(runtime::default_scheduler));
    settings.scheduler = runtime::scheduler_from_string(only(settings.shared.schedulers, scheduler, "--scheduler"));
    if (settings.scheduler == runtime::SchedulerKind::serial && settings.threads > 1) {
        throw Error("--threads: the serial scheduler has one thread, expected 1");
    }
    if (!settings.shared.instruction_sets.empty()) {
        const std::string name = only(settings.shared.instruction_sets, std::string(), "--isa");
        settings.instruction_set = kernels::instruction_set_from_string(name);
        kernels::require(settings.instruction_set);
    }
    return settings;
}

}  // namespace lancet::experiments::cutting
