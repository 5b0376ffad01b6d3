#pragma once

#include <memory>

#include "lancet/experiments/common/renderer.hpp"
#include "lancet/experiments/pipeline/settings.hpp"
#include "lancet/runtime/simulate/simulation.hpp"

namespace lancet::experiments::pipeline {

/// A scene with one body and one tool, and how it is played and looked at.
struct World {
    std::unique_ptr<runtime::Simulation> simulation;
    int body = 0;
    int tool = 0;
    Camera camera;
    runtime::CapsuleTool tool_shape;
    std::size_t elements = 0;
    Point lower{}, upper{};  ///< box around the body at rest
    double sag = 0;          ///< of its middle, about, in shares of its height
};

/// Builds a scene by its name. Throws lancet::Error as runtime::Simulation does.
[[nodiscard]] World make_world(const PipelineSettings& settings, runtime::Scheduler& scheduler);

/// What the hand does in a scene, over and over: it pokes, grabs and lifts, strokes along, and once every other time
/// cuts a little further into the body. A sample at each tick of the device.
[[nodiscard]] runtime::ToolPath built_in_path(const World& world, const PipelineSettings& settings);

}  // namespace lancet::experiments::pipeline
