#pragma once

#include <cstdint>
#include <vector>

#include "lancet/runtime/simulate/scene.hpp"

namespace lancet::runtime {

/// A component of the mesh that the constraints leave free to move as a rigid body.
struct FloatingComponent {
    std::int32_t component;   ///< as numbered by mesh::components
    std::int32_t nodes;       ///< how many it has
    std::int32_t first_node;  ///< the lowest of them
    int free_motions;         ///< how many of the six rigid motions are left
};

/// The floating components of a scene, by its fixed nodes and prescribed displacements. Throws lancet::Error for
/// constraints that make no sense (see validate_constraints).
std::vector<FloatingComponent> floating_components(const Scene& scene);

}  // namespace lancet::runtime
