#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lancet/experiments/scheduler/measured.hpp"

namespace lancet::experiments::scheduler {

/// Forms that differ by less are not told apart: on one thread the serial step and the loops of any scheduler are the
/// same code, and differ by up to 2 % by where their arrays happen to lie.
inline constexpr double resolution_percent = 2;

/// One of the aims for the speed of a step, and what became of it.
struct Target {
    std::string what{};
    std::int64_t elements = 0;
    int threads = 1;
    std::string form{};
    bool is_at_most = true;  ///< else: at least
    double bound = 0;        ///< percent
    Spread percent{};
    std::optional<Spread> side{}, graph{};  ///< percent of the bare step: the extras' own work, and what is in no task
    std::optional<Spread> beside{}, at_most{};  ///< percent of the frames' time: see Measured

    /// "yes" or "no" where all repetitions agree, else "within noise".
    std::string is_met() const;
};

/// The aims, for all bars: with everything on at most 3 % over the bare solve and with nothing at most 1 % (one
/// thread); at least 80 % of the frames' time hidden (two threads).
std::vector<Target> targets(std::span<const Measured> rows);

/// What follows from the rows: for each bar, number of threads and extras which form is the fastest, and which of the
/// others differ from it by less than the resolution, or than repetitions differ among each other; then the targets;
/// then bits.
std::vector<std::string> verdict(std::span<const Measured> rows, std::span<const Target> targets);

}  // namespace lancet::experiments::scheduler
