#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "lancet/experiments/cutting/scenario.hpp"
#include "lancet/experiments/cutting/shape.hpp"

namespace lancet::experiments::cutting {

/// Draws shapes of one body beside each other and all to one scale, the walls of cuts in a colour of their own. Writes
/// NAME-0.dat, NAME-1.dat ... and NAME.gp and, with gnuplot, NAME.png to `folder`, each as a whole. Returns what kept
/// the picture from being drawn (no gnuplot), else nothing. Throws lancet::Error for a folder that cannot be written.
[[nodiscard]] std::string draw(std::span<const Shape> shapes, const View& view, const std::string& title,
                               const std::filesystem::path& folder, const std::string& name);

}  // namespace lancet::experiments::cutting
