#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lancet/experiments/common/table.hpp"
#include "lancet/experiments/scaling/rows.hpp"

namespace lancet::experiments::scaling {

/// What Jerabkova (2007) measured, as far as it is known here.
struct ThesisRun {
    std::string benchmark;
    int cores = 1;
    double seconds = 0;
    std::optional<double> speedup, cg_share_percent;
    std::string note;
};
[[nodiscard]] const std::vector<ThesisRun>& thesis_runs();

/// Rows in the form of table 5.1: the whole run of each benchmark in seconds by cores, and the highest speed-up, the
/// thesis' own line before those of series "thesis".
[[nodiscard]] Table make_table_5_1(std::span<const Row> rows);

/// The numbers of figures 5.8 and 5.9: speed-up over the serial run in natural order, and the part of the time that
/// conjugate gradients take, by cores.
[[nodiscard]] Table make_figures_5_8_and_5_9(std::span<const Row> rows);

}  // namespace lancet::experiments::scaling
