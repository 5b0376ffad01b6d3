#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lancet/experiments/common/options.hpp"
#include "lancet/experiments/cutting/scenario.hpp"
#include "lancet/kernels/isa/instruction_set.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::experiments::cutting {

/// What the user asked for, with the experiment's defaults filled in.
struct CuttingSettings {
    SharedOptions shared;
    std::vector<std::string> scenes, operators, scalars;
    std::optional<OrganFile> organ;
    int levels = 0;
    int repetitions = 0;
    std::filesystem::path pvd, plot;  ///< folders; empty: nothing is written
    runtime::SchedulerKind scheduler = runtime::SchedulerKind::serial;
    int threads = 1;
    kernels::InstructionSet instruction_set = kernels::active_instruction_set();
};

/// All scenes, in the order in which they run.
[[nodiscard]] const std::vector<std::string>& scene_names();

/// Parses the command line; nothing when --help was printed. Throws lancet::Error for what makes no sense.
[[nodiscard]] std::optional<CuttingSettings> parse_settings(int argc, const char* const* argv);

}  // namespace lancet::experiments::cutting
