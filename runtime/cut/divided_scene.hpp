#pragma once

#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/runtime/simulate/scene.hpp"

namespace lancet::runtime {

/// A scene with cuts as a scene without: its nodes are the copies of the cut mesh, and its elements the parts. Parts of
/// one element whose corners all have the same copies, as around a cut that separates nothing there, are one element.
///
/// Fixed nodes, prescribed displacements and node sets hold for all copies of their nodes. Loads act on the material:
/// what lies on an edge or a triangle goes to the parts there, and a force on a node to the copy that holds the node.
///
/// Throws lancet::Error where the cut mesh is not that of the scene, or the scene has been divided before.
Scene divided(const Scene& scene, const mesh::CutMesh& cut);

}  // namespace lancet::runtime
