#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"
#include "lancet/runtime/simulate/scene.hpp"

namespace lancet::experiments::cutting {

using mesh::Point;

/// A cut of a moving body. Its surface is given at rest: strokes that share the places of the blade then leave no gap,
/// however the body moves between them, and every arithmetic cuts the same, so that what it gets wrong can be told.
struct Stroke {
    int step = 0;  ///< it is made before this step
    mesh::CutSurface surface;
    mesh::FrontTreatment front = mesh::FrontTreatment::retract;
};

/// From where a scene is looked at.
struct View {
    std::array<Point, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< to the right, to the back, up
    double elevation = 70;                                         ///< degrees from straight above
    double azimuth = 30;                                           ///< degrees about the upward axis
    std::vector<int> steps{};                                      ///< after which pictures are taken
};

/// A body that is cut while it moves. SI units.
struct Scenario {
    std::string name;
    std::string title;  ///< one line: what is shown
    runtime::Scene scene;
    double time_step = 0;
    int steps = 0;
    std::vector<Stroke> strokes{};  ///< ascending by step
    View view{};
};

/// A mesh of the user's for the scene `organ`.
struct OrganFile {
    std::filesystem::path file;
    std::optional<double> scale;  ///< factor on its coordinates, to get metres; nothing: its longest side is 0.2 m
};

/// The beam of Schoch et al. 2013 (0.03 x 0.06 x 0.2 m), cut half through in the middle, bending under gravity.
[[nodiscard]] Scenario dissected_beam(bool is_quick);

/// An organ that is held at one end and cut from above along a plane: generated, or read from a file. Throws
/// lancet::Error for a file that cannot be read and a scale that is not positive.
[[nodiscard]] Scenario organ(const std::optional<OrganFile>& file, bool is_quick);

/// The Bar, through which a blade goes from above while it swings. The strokes are those of a runtime::Blade in the
/// hand of somebody who follows the Bar, found by a run in double.
[[nodiscard]] Scenario scalpel(bool is_quick, runtime::Scheduler& scheduler);

/// The Bar at rest, clamped at x = 0: 40 x 8 x 8 cells of 0.1 m, or half as many along each axis.
[[nodiscard]] runtime::Scene bar(bool is_quick);

}  // namespace lancet::experiments::cutting
