#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lancet/experiments/common/table.hpp"
#include "lancet/experiments/scaling/amdahl.hpp"
#include "lancet/experiments/scaling/load.hpp"
#include "lancet/experiments/scaling/measure.hpp"
#include "lancet/experiments/scaling/plan.hpp"

namespace lancet::experiments::scaling {

/// One row of a series. Times are medians over the repetitions that count (see LoadMark).
struct Row {
    std::string series;
    Job job;
    Report report;  ///< of the repetition with the median time (the lower one of two in the middle)
    std::size_t repetitions = 0, counted = 0;
    double ms_per_step = 0, ms_minimum = 0, ms_maximum = 0;
    std::optional<double> spread_percent;  ///< quartiles over the median; missing for one repetition
    /// Elements a second over those of one thread of the same scheduler, and of the serial run in natural order: for
    /// equal sizes the speed-up, for a weak series the scaled one. Missing where either row is meaningless.
    std::optional<double> speedup, speedup_over_serial;
    std::optional<bool> is_bit_identical;  ///< all repetitions end like the serial scheduler's; not in natural order
    double peak_gflops = 0, read_gbytes_per_s = 0;  ///< the best of all repetitions
    LoadMark mark = LoadMark::quiet;
    double lost = 0, others = 0;  ///< medians over all repetitions: share of time; cores
    bool is_oversubscribed = false;
    bool is_base_loaded = false;  ///< a row that a speed-up is formed with is loaded

    [[nodiscard]] double seconds() const { return 1e-3 * ms_per_step * job.steps; }
    [[nodiscard]] std::string note() const;
};

/// The rows of a plan from what was measured; `repetitions` were asked for.
[[nodiscard]] std::vector<Row> make_rows(const Plan& plan, const Measurement& measurement, int repetitions);

/// The rows as a table, with these of its columns, or all.
[[nodiscard]] Table make_table(std::span<const Row> rows, std::span<const std::string_view> keys = {});

/// Amdahl's law fitted to one series of a scheduler.
struct SerialFraction {
    Job job;  ///< with one thread
    std::int64_t elements = 0;
    int counts = 0;  ///< different thread counts that could be used: at most as many threads as cores, not meaningless
    std::optional<AmdahlFit> fit;  ///< missing for less than three
};

/// A fit for each scheduler and choice of the strong series.
[[nodiscard]] std::vector<SerialFraction> fit_serial_fractions(std::span<const Row> rows);

[[nodiscard]] Table make_table(std::span<const SerialFraction> fractions);

}  // namespace lancet::experiments::scaling
