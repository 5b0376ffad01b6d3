#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace lancet::experiments {

/// A text as a string of gnuplot.
[[nodiscard]] std::string quoted(const std::string& text);

/// Makes the folder that --plot names. Throws lancet::Error where it cannot be made.
void make_plot_folder(const std::filesystem::path& folder);

/// Runs gnuplot on `folder`/`name`.gp, which writes pictures to `name``ending`.part, with `part` its variable for what
/// follows the ending; they appear by rename. Returns why there is no picture, or nothing where there is.
[[nodiscard]] std::string run_gnuplot(const std::filesystem::path& folder, const std::string& name,
                                      std::span<const std::string> endings);

}  // namespace lancet::experiments
