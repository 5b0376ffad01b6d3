#pragma once

#include <optional>

#include "lancet/experiments/common/options.hpp"

namespace lancet::experiments::skips {

/// What the user asked for, with the experiment's defaults filled in.
struct SkipsSettings {
    SharedOptions shared;
    int repetitions = 0;
    int units = 0;  ///< steps that are timed in a repetition
};

/// Parses the command line; nothing when --help was printed. Throws lancet::Error for what makes no sense: everything
/// runs on one thread, without a scheduler.
[[nodiscard]] std::optional<SkipsSettings> parse_settings(int argc, const char* const* argv);

}  // namespace lancet::experiments::skips
