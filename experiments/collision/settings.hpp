#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lancet/experiments/common/options.hpp"
#include "lancet/runtime/collide/broad_phase.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::experiments::collision {

/// What the user asked for, with the experiment's defaults filled in.
struct CollisionSettings {
    SharedOptions shared;
    std::vector<std::string> scenes;
    std::vector<runtime::BroadPhaseKind> kinds;
    std::vector<int> primitives;
    int steps = 0;
    int repetitions = 0;
    double most_tests = 0;  ///< of boxes a step that brute force is run with
    runtime::SchedulerKind scheduler = runtime::SchedulerKind::serial;
    int threads = 1;
};

/// Parses the command line; nothing when --help was printed. Throws lancet::Error for what makes no sense.
[[nodiscard]] std::optional<CollisionSettings> parse_settings(int argc, const char* const* argv);

}  // namespace lancet::experiments::collision
