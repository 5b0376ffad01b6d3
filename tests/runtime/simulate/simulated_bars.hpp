#pragma once

#include <array>
#include <string>
#include <vector>

#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/simulate/simulation.hpp"

namespace lancet::runtime::test {

inline constexpr double time_step = 0.02;

/// A bar of 0.8 x 0.2 x 0.2 m along x; held at x = 0, or free.
inline BodyDefinition bar(const std::string& name, bool is_held = true, const Point& origin = {0, 0, 0}) {
    BodyDefinition definition{.name = name};
    definition.scene.mesh = mesh::box({.cells = {8, 2, 2}, .size = {0.8, 0.2, 0.2}, .origin = origin});
    definition.scene.materials[0].young_modulus = 1e6;
    if (is_held) {
        const auto nodes = definition.scene.mesh.node_set("x_min");
        definition.scene.fixed_nodes.assign(nodes.begin(), nodes.end());
    }
    definition.settings.time_step = time_step;
    return definition;
}

inline std::vector<Point> positions(SimulatedBody& body) {
    std::vector<Point> result(body.body().nodes());
    body.body().positions(result);
    return result;
}

inline ToolDefinition knife() {
    return {.name = "knife",
            .shape = SphereTool{.radius = 0.04},
            .blade = std::array<Point, 2>{{{0, 0, -0.5}, {0, 0, 0.5}}},
            .grab_distance = 0.05};
}

}  // namespace lancet::runtime::test
