#pragma once

#include <optional>

#include "lancet/experiments/skips/items.hpp"

namespace lancet::experiments::skips {

/// What skipping something brings, and what it costs.
struct Gain {
    double ms_with = 0, ms_without = 0;  ///< of a unit: lower quartiles, for what else runs can only lengthen them
    double ratio = 0, lowest = 0,
           highest = 0;            ///< with over without: of lower quartiles; median, lowest and highest repetition
    bool compares_motion = false;  ///< whether there were positions to compare
    bool same_bits = false;        ///< of positions, after every repetition
    double error_percent = 0;      ///< rms of the difference of positions over 4 m, the bar's length
    std::optional<double> bytes_with{}, bytes_without{};

    /// Whether all repetitions agree which is faster.
    bool is_above_noise() const noexcept { return highest < 1 || lowest > 1; }
};

/// Times both in turns, unit by unit; each repetition starts anew.
Gain measure(const Item& item, int units, int repetitions);

}  // namespace lancet::experiments::skips
