#include "lancet/runtime/simulate/held_scene.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/components.hpp"
#include "lancet/runtime/simulate/floating.hpp"
#include "lancet/runtime/simulate/scene_layout.hpp"

namespace lancet::runtime {
namespace {

using mesh::Point;

/// Fixes three nodes of a component as a table on three legs: one wholly, one across the line to it, one out of the
/// plane; each leg in the axis that suits best.
void hold_component(const mesh::TetMesh& mesh, std::span<const std::int32_t> nodes,
                    std::vector<PrescribedDisplacement>& prescribed) {
    const auto at = [&](std::int32_t node) { return mesh.nodes()[static_cast<std::size_t>(node)]; };
    const auto none = [](double) { return 0.0; };
    const auto farthest = [&](const auto& distance) {
        return *std::max_element(nodes.begin(), nodes.end(),
                                 [&](std::int32_t a, std::int32_t b) { return distance(at(a)) < distance(at(b)); });
    };
    const std::int32_t first = nodes.front();
    const Point a = at(first);
    const auto from_first = [&](const Point& p) { return Point{p[0] - a[0], p[1] - a[1], p[2] - a[2]}; };
    const auto length = [](const Point& p) { return std::hypot(p[0], p[1], p[2]); };
    const auto cross = [](const Point& p, const Point& q) {
        return Point{p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
    };
    const std::int32_t second = farthest([&](const Point& p) { return length(from_first(p)); });
    const Point line = from_first(at(second));
    const std::int32_t third = farthest([&](const Point& p) { return length(cross(line, from_first(p))); });
    const Point normal = cross(line, from_first(at(third)));
    const auto largest = [](const Point& p) {
        const auto smaller = [](double x, double y) { return std::abs(x) < std::abs(y); };
        return static_cast<int>(std::max_element(p.begin(), p.end(), smaller) - p.begin());
    };
    const int along = largest(line);
    for (int axis = 0; axis < 3; ++axis) {
        prescribed.push_back({first, axis, none});
        if (axis != along) prescribed.push_back({second, axis, none});
    }
    // What is left is a turn about the line, which moves the third node along the normal.
    prescribed.push_back({third, largest(normal), none});
}

}  // namespace

HeldScene hold_scene(const Scene& scene, bool hold_floating) {
    validate_constraints(scene);
    HeldScene held{scene, scene.prescribed};
    const std::vector<FloatingComponent> floating = floating_components(scene);
    if (!floating.empty() && !hold_floating) {
        const FloatingComponent& f = floating.front();
        throw Error(std::to_string(floating.size()) + " component(s) of the mesh can move as rigid bodies: component " +
                    std::to_string(f.component) + ", with " + std::to_string(f.nodes) + " nodes from node " +
                    std::to_string(f.first_node) + ", has " + std::to_string(f.free_motions) +
                    " free motions; expected constraints that hold it, or hold_floating");
    }
    if (!floating.empty()) {
        const mesh::Components parts = mesh::components(scene.mesh);
        for (const FloatingComponent& f : floating) {
            if (f.free_motions < 6) {
                throw Error("component " + std::to_string(f.component) + " of the mesh is held in part, with " +
                            std::to_string(f.free_motions) +
                            " free motions; hold_floating holds components that nothing else holds");
            }
            std::vector<std::int32_t> nodes;
            for (std::size_t node = 0; node < parts.of_node.size(); ++node) {
                if (parts.of_node[node] == f.component) nodes.push_back(static_cast<std::int32_t>(node));
            }
            hold_component(scene.mesh, nodes, held.prescribed);
            ++held.components;
        }
    }
    std::vector<int> known(scene.mesh.nodes().size(), 0);
    for (const PrescribedDisplacement& p : held.prescribed) {
        known[static_cast<std::size_t>(p.node)] |= 1 << p.axis;
    }
    for (std::size_t node = 0; node < known.size(); ++node) {
        if (known[node] == 7) held.scene.fixed_nodes.push_back(static_cast<std::int32_t>(node));
    }
    held.scene.prescribed.clear();
    held.fixed_nodes_hold = floating_components(held.scene).empty();
    return held;
}

}  // namespace lancet::runtime
