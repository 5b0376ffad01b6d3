#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "lancet/experiments/precision/run.hpp"

namespace lancet::experiments::precision {

/// Which error a diagram shows.
enum class Shown {
    judged,   ///< Errors::judged(), with the front that the rows have
    quantity  ///< of the quantity of interest alone, with a front of its own
};

/// Draws the work-precision diagram of rows of one problem: wall-clock seconds against an error, both logarithmic, a
/// series for each Setting::series, the Pareto front on top. Writes NAME.dat, NAME.gp and, with gnuplot, NAME.svg and
/// NAME.png to `folder`, each as a whole. Returns what kept the pictures from being drawn (no gnuplot), else nothing.
/// Throws lancet::Error for a folder that cannot be written.
[[nodiscard]] std::string draw(std::span<const Row> rows, Shown shown, const std::string& title,
                               const std::filesystem::path& folder, const std::string& name);

}  // namespace lancet::experiments::precision
