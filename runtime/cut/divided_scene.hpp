#pragma once

#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/mesh/cut/lanes.hpp"
#include "lancet/runtime/simulate/scene.hpp"

namespace lancet::runtime {

/// A scene with cuts as a scene without: its nodes are the copies of the cut mesh and, with blended fronts, those that
/// are opening; its elements are the lanes (see lanes.hpp).
///
/// Fixed nodes, prescribed displacements and node sets hold for all copies of their nodes. Loads act on the material:
/// what lies on an edge or a triangle goes to the parts there, and a force on a node to the copy that holds the node.
/// On parts around a blended front they act as if it were closed.
///
/// `opened_from`, where it is asked for, becomes that of the lanes. Lanes of less than `smallest_fraction` are raised
/// to it, see mesh::raise_fractions.
///
/// Throws lancet::Error where the cut mesh is not that of the scene, or the scene has been divided before.
Scene divided(const Scene& scene, const mesh::CutMesh& cut, mesh::Fronts fronts = mesh::Fronts::sharp,
              std::vector<std::int32_t>* opened_from = nullptr, double smallest_fraction = 0);

/// What thinner parts are taken as: 1e-20 of an element, far below the rounding of every sum that it enters, and thick
/// enough that a float holds its stiffness.
mesh::PartMoments smallest_moments();
/// The moments of a part, or the smallest.
mesh::PartMoments at_least_smallest(const mesh::PartMoments& moments);

}  // namespace lancet::runtime
