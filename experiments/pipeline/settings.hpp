#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "lancet/experiments/common/options.hpp"
#include "lancet/runtime/simulate/simulation.hpp"

namespace lancet::experiments::pipeline {

/// The command line of the experiment, checked and completed.
struct PipelineSettings {
    SharedOptions shared{};
    std::string scene = "bar";  ///< or organ
    double seconds = 60;        ///< simulated
    double time_step = 0.005;   ///< s
    double frame_rate = 30;     ///< Hz
    double collision_rate = 200;
    double force_rate = 1000;
    bool is_paced = true;  ///< by the clock; else as fast as it goes
    bool overlaps = true;  ///< see runtime::SimulationOptions::overlap
    bool cuts = true;
    int width = 480, height = 270;
    std::filesystem::path path{};    ///< of the tool, to be played; else the built-in one
    std::filesystem::path record{};  ///< where the tool's samples are written
    std::filesystem::path trace{};
    std::filesystem::path frames{};  ///< folder of pictures and of files for ParaView
    std::filesystem::path dot{};
    std::optional<double> soak{};  ///< simulated minutes of random input, instead of the scene
    std::uint64_t seed = 1;
    runtime::SchedulerKind scheduler = runtime::default_scheduler;
    int threads = 1;
    kernels::InstructionSet instruction_set = kernels::active_instruction_set();
};

/// Reads the command line; nothing where --help was asked for. Throws lancet::Error for what makes no sense.
[[nodiscard]] std::optional<PipelineSettings> parse_settings(int argc, const char* const* argv);

}  // namespace lancet::experiments::pipeline
