#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lancet/experiments/common/options.hpp"

namespace lancet::experiments::scaling {

/// What the user asked for, complete.
struct ScalingSettings {
    SharedOptions shared;
    std::vector<std::string> series;      ///< out of series_names()
    std::vector<std::string> benchmarks;  ///< out of benchmark_names()
    std::vector<int> elements;            ///< empty: each benchmark's own default_elements()
    std::string setting = "default";      ///< default or original
    std::vector<int> threads;             ///< ascending, 1 always among them
    std::vector<std::string> schedulers;  ///< without serial, which always runs
    std::vector<std::string> instruction_sets, scalars, operators, scatters;  ///< the first is what series go by
    bool varies_one_by_one = true;  ///< no list of these four was given: the others stand in series "variants" only
    int steps = 0;
    int repetitions = 0;
    int extra_rounds = -1;  ///< of rows that the machine's load has disturbed; -1: not given
    bool pin = false;
    bool no_errors = false;
    std::filesystem::path plot{};  ///< empty: no pictures
    std::filesystem::path cache;
};

/// - strong: the same size on more threads
/// - weak: as many elements for each thread, of the smallest size
/// - variants: other instruction sets, scalar types, operators and scatter strategies, one at a time, on the first
///   benchmark in its smallest size
/// - thesis: the whole runs of the original, in its setting
[[nodiscard]] const std::vector<std::string>& series_names();

/// The sizes of a benchmark that series strong and weak have by default.
[[nodiscard]] std::vector<int> default_elements(const std::string& benchmark, bool is_quick);

/// Reads the command line. Nothing where --help was asked for and printed. Throws lancet::Error for options that say
/// nothing, or what this machine cannot do.
[[nodiscard]] std::optional<ScalingSettings> parse_settings(int argc, const char* const* argv);

}  // namespace lancet::experiments::scaling
