#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "lancet/experiments/bar/problem.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/simulate/scene.hpp"
#include "lancet/runtime/simulate/settings.hpp"

namespace lancet::experiments::precision {

/// A box, its longest axis along x, held at x = 0: what statics are measured on. SI units.
struct StaticProblem {
    std::string problem;
    std::string variant;
    runtime::ElementModel model = runtime::ElementModel::corotational;
    bar::ProblemOptions options;               ///< cells are those of the coarsest mesh; the others double them
    std::array<double, 3> end_load{};          ///< N, spread over the face x = length
    std::array<std::optional<double>, 3> tip;  ///< published displacement of the middle of that face, m
    int judged_axis = 1;                       ///< the component that tables show
    std::string source;                        ///< of `tip`
    double source_percent = 0;                 ///< how far `tip` may be trusted
    int levels = 3;                            ///< meshes that a full run measures
    bool is_quick = true;                      ///< part of a quick run

    /// The middle of the face x = length.
    [[nodiscard]] mesh::Point tip_point() const;
    /// The box of the mesh whose cells are doubled `level` times.
    [[nodiscard]] mesh::Box box(int level) const;
};

/// All of them, in the order of the tables.
[[nodiscard]] std::vector<StaticProblem> static_problems();

/// The options of the problem on the mesh of a level: what the baseline is given too.
[[nodiscard]] bar::ProblemOptions options_of(const StaticProblem& problem, int level);

/// The scene of a problem on the mesh of a level.
[[nodiscard]] runtime::Scene scene_of(const StaticProblem& problem, int level);

}  // namespace lancet::experiments::precision
