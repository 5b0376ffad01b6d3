#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "lancet/experiments/scaling/rows.hpp"

namespace lancet::experiments::scaling {

/// Draws, as SVG and PNG with the data and the script beside:
/// - speedup: over the natural order by threads, strong series, with the ideal
/// - efficiency: of the weak series
/// - figure-5-8, figure-5-9: the thesis' speed-up curves, and the part of the time in conjugate gradients
/// Meaningless rows are left out. Returns why there are no pictures, or nothing where there are. Throws
/// lancet::Error where the folder cannot be made or written to.
[[nodiscard]] std::string draw(std::span<const Row> rows, const std::filesystem::path& folder);

}  // namespace lancet::experiments::scaling
