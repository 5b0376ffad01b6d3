#include "lancet/experiments/collision/settings.hpp"

#include <algorithm>

#include <CLI/CLI.hpp>

#include "lancet/experiments/collision/scene.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::collision {
namespace {

using Words = std::vector<std::string>;

}  // namespace

std::optional<CollisionSettings> parse_settings(int argc, const char* const* argv) {
    CollisionSettings settings;
    Words kinds, all_kinds;
    for (const runtime::BroadPhaseKind kind : runtime::broad_phase_kinds()) all_kinds.emplace_back(to_string(kind));
    CLI::App app("Collision: what finds the boxes that touch, and how fast");
    add_shared_options(app, settings.shared);
    add_words(app, "--scene", settings.scenes, {scene_names().begin(), scene_names().end()}, "Only these scenes");
    add_words(app, "--kind", kinds, all_kinds, "Only these broad phases");
    app.add_option_function<std::string>(
           "--primitives",
           [&settings](const std::string& text) { settings.primitives = parse_counts("--primitives", text, 100); },
           "Sizes, a list of about so many triangles or tetrahedra; 1000,10000,100000, with --quick the first two")
        ->type_name("LIST");
    app.add_option("--steps", settings.steps, "Steps of the motion; 20, or 6 with --quick")
        ->check(CLI::Range(2, 10000));
    app.add_option("--repetitions", settings.repetitions, "Runs of everything, interleaved; 5, or 2 with --quick")
        ->check(CLI::Range(1, 1000));
    if (!parse_command_line(app, argc, argv)) return std::nullopt;

    const bool is_quick = settings.shared.quick;
    if (settings.scenes.empty()) settings.scenes.assign(scene_names().begin(), scene_names().end());
    for (const std::string& kind : kinds.empty() ? all_kinds : kinds) {
        settings.kinds.push_back(runtime::broad_phase_from_string(kind));
    }
    if (settings.primitives.empty()) {
        settings.primitives = is_quick ? std::vector{1000, 10000} : std::vector{1000, 10000, 100000};
    }
    std::ranges::sort(settings.primitives);
    if (settings.steps == 0) settings.steps = is_quick ? 6 : 20;
    if (settings.repetitions == 0) settings.repetitions = is_quick ? 2 : 5;
    settings.most_tests = is_quick ? 1e8 : 1e9;
    settings.threads = only(settings.shared.threads, 1, "--threads");
    const std::string scheduler(settings.threads == 1 ? "serial" : runtime::to_string(runtime::default_scheduler));
    settings.scheduler = runtime::scheduler_from_string(only(settings.shared.schedulers, scheduler, "--scheduler"));
    if (settings.scheduler == runtime::SchedulerKind::serial && settings.threads > 1) {
        throw Error("--threads: the serial scheduler has one thread, expected 1");
    }
    if (!settings.shared.instruction_sets.empty()) throw Error("--isa: collision detection has no kernels to choose");
    if (!settings.shared.scalars.empty() && settings.shared.scalars != Words{"double"}) {
        throw Error("--scalar: collision detection is in double");
    }
    return settings;
}

}  // namespace lancet::experiments::collision
