#pragma once

#include <string>

#include "lancet/experiments/bar/problem.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"
#include "lancet/runtime/simulate/scene.hpp"
#include "lancet/runtime/simulate/settings.hpp"

namespace lancet::experiments::bar {

/// How a worker has Lancet solve a problem: the words of the command line.
struct LancetOptions {
    std::string scalar = "float";
    std::string isa;  ///< empty: the active one
    std::string scheduler{runtime::to_string(runtime::default_scheduler)};
    std::string matrix = "edge-blocks";
    std::string scatter = "private-copies";
    std::string preconditioner = "coarse";
    std::string linearise = "prediction";
    std::string rotation = "robust";
    std::string mass = "lumped";
    std::string ordering = "hilbert";
    int threads = 1;
    int cg_iterations = 10;
    double cg_tolerance = 0;
    int rotation_interval = 1;
    double newton_tolerance = 0;
    bool no_safeguard = false;
    int nodes_per_block = 0;
    int nodes_per_aggregate = 0;
    double coarse_change = runtime::Settings{}.coarse_change;
};

/// Adds them to a program. `o` must outlive the parse; it holds the defaults.
void add_lancet_options(CLI::App& app, LancetOptions& o);

/// What the words mean. Throws lancet::Error for words that name nothing.
[[nodiscard]] runtime::Settings settings_of(const LancetOptions& o, const Problem& problem);

/// The problem as the library takes it.
[[nodiscard]] runtime::Scene scene_of(const Problem& problem);

}  // namespace lancet::experiments::bar
