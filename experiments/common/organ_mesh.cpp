#include "lancet/experiments/common/organ_mesh.hpp"

#include <cmath>
#include <utility>

#include "lancet/mesh/generate/cylinder.hpp"

namespace lancet::experiments {

mesh::TetMesh organ_mesh(int rings, int layers) {
    // s along the rod in [-1, 1], (y, z) in the unit disc.
    const mesh::TetMesh rod = mesh::cylinder(
        {.length = 2, .radius = 1, .cells_along = layers, .cells_across = rings, .axis = 0, .origin = {-1, 0, 0}});
    mesh::TetMesh::Definition definition = rod.definition();
    definition.node_sets.clear();
    for (mesh::Point& node : definition.nodes) {
        const auto [s, y, z] = node;
        const double taper = std::sqrt(1 - 0.7 * s * s) * (1 - 0.2 * s);
        const double bulge = s * s * s * (1 - y * y - z * z) / 12;
        node = {0.09 * (s + bulge), 0.05 * taper * y,
                0.035 * taper * z * (1 + 0.35 * y) - 0.02 * s * s + 0.008 * y * y};
    }
    return mesh::TetMesh(std::move(definition));
}

}  // namespace lancet::experiments
