#pragma once

#include <filesystem>

#include "lancet/experiments/bar/problem.hpp"
#include "lancet/experiments/bar/settings.hpp"

namespace lancet::experiments::bar {

/// The name under which the pictures of a row are found, such as eigen-original-float-1.
[[nodiscard]] std::string picture_name(const Job& job, const std::string& scalar);

/// Runs `job` once more and writes the motion for ParaView: `folder`/`name`.pvd and at most 26 meshes with the array
/// `displacement`, evenly over the simulated time, in `folder`/`name`. Throws lancet::Error where that fails.
void write_pictures(const Job& job, const ProblemOptions& options, const Problem& problem,
                    const std::filesystem::path& folder, const std::string& name);

}  // namespace lancet::experiments::bar
