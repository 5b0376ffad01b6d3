#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lancet/experiments/common/progress.hpp"
#include "lancet/experiments/common/table.hpp"
#include "lancet/experiments/pipeline/settings.hpp"

namespace lancet::experiments::pipeline {

/// One life of a world between resets.
struct SoakRound {
    std::int64_t round = 0;
    double seconds = 0;  ///< simulated
    std::int64_t cuts = 0;
    std::int64_t copies = 0;
    std::int64_t lost_steps = 0;
    double largest_speed = 0;   ///< m / s, ever
    double memory_mbytes = 0;   ///< resident after the reset
    std::string fingerprint{};  ///< of the standard strokes at the start of each life
    bool is_finite = true;
};

struct Soak {
    std::vector<SoakRound> rounds;
    /// What did not hold: states that are not finite, memory that grew, lives that began differently. Empty: all held.
    std::vector<std::string> complaints;
};

/// Runs `settings.soak` simulated minutes of random tool input and cuts, with a reset every few seconds. Each life
/// begins with the same strokes, which must come to the same bits in each; memory after resets must not grow.
[[nodiscard]] Soak run_soak(const PipelineSettings& settings, Progress& progress);

[[nodiscard]] Table soak_table(const Soak& soak);

}  // namespace lancet::experiments::pipeline
