#pragma once

#include <vector>

#include "lancet/runtime/simulate/scene.hpp"

namespace lancet::runtime {

using mesh::Point;

/// The dead loads of a scene on each node of its mesh, in newtons, without gravity: nodal loads, edge loads (half at
/// each end) and tractions (a third of each triangle's force at each corner; exact for linear elements).
/// Throws lancet::Error for nodes that do not exist, edges without length, triangles without area, or forces that are
/// not finite.
std::vector<Point> external_loads(const Scene& scene);

/// Triangles of the boundary whose corners all satisfy `is_inside(point)`: what a traction acts on.
template <class Predicate>
std::vector<mesh::Triangle> triangles_where(const mesh::TetMesh& mesh, std::span<const mesh::Triangle> boundary,
                                            const Predicate& is_inside) {
    std::vector<mesh::Triangle> chosen;
    for (const mesh::Triangle& triangle : boundary) {
        bool all = true;
        for (const std::int32_t node : triangle) all = all && is_inside(mesh.nodes()[static_cast<std::size_t>(node)]);
        if (all) chosen.push_back(triangle);
    }
    return chosen;
}

}  // namespace lancet::runtime
