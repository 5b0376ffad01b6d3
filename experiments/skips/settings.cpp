#include "lancet/experiments/skips/settings.hpp"

#include <CLI/CLI.hpp>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::skips {

std::optional<SkipsSettings> parse_settings(int argc, const char* const* argv) {
    SkipsSettings settings;
    CLI::App app("Skips: what is left out where a scene does not need it, what that saves and what it gets wrong");
    add_shared_options(app, settings.shared);
    app.add_option("--repetitions", settings.repetitions, "Runs of everything; 5, or 3 with --quick")
        ->check(CLI::Range(1, 1000));
    if (!parse_command_line(app, argc, argv)) return std::nullopt;
    const auto refuse = [](bool is_given, const std::string& option) {
        if (is_given) throw Error(option + ": this experiment runs its scenes in float on one thread, as they are");
    };
    refuse(!settings.shared.threads.empty(), "--threads");
    refuse(!settings.shared.schedulers.empty(), "--scheduler");
    refuse(!settings.shared.instruction_sets.empty(), "--isa");
    refuse(!settings.shared.scalars.empty(), "--scalar");
    if (settings.repetitions == 0) settings.repetitions = settings.shared.quick ? 3 : 5;
    settings.units = settings.shared.quick ? 50 : 125;
    return settings;
}

}  // namespace lancet::experiments::skips
