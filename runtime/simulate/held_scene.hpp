#pragma once

#include <vector>

#include "lancet/runtime/simulate/scene.hpp"

namespace lancet::runtime {

/// What the constraints of a scene come to where it is at rest: nodes whose three components are known leave the system
/// of equations, others slide.
struct HeldScene {
    Scene scene;  ///< with those nodes fixed, and nothing prescribed
    std::vector<PrescribedDisplacement> prescribed;
    int components = 0;            ///< that could float, and are held now
    bool fixed_nodes_hold = true;  ///< the nodes that leave the system hold every component alone
};

/// Finds it. With `hold_floating`, components of the mesh that nothing holds are held at three of their nodes, without
/// force where their loads are in balance. Throws lancet::Error where something could move as a rigid body otherwise,
/// and for a component that is held in part.
HeldScene hold_scene(const Scene& scene, bool hold_floating);

}  // namespace lancet::runtime
