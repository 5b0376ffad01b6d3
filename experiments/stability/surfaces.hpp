#pragma once

#include <span>

#include "lancet/experiments/stability/random.hpp"
#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/mesh/cut/cut_surface.hpp"

namespace lancet::experiments::stability {

/// A random surface through or near an element, whose part `part` now has its corners at `positions` (of all copies):
/// a plane, a half-plane, a parallelogram, triangles, what a blade sweeps, or a level set.
///
/// It hangs on three points, which are random places in the element, or its nodes: one, two or three of them, so that
/// the surface goes through a node, along an edge or along a face, with the coordinates of the mesh. Any of them may be
/// moved by one unit in the last place of a coordinate.
mesh::CutSurface random_surface(const mesh::CutMesh& cut, std::int32_t part, std::span<const mesh::Point> positions,
                                Random& random);

/// The triangles opposite to a node in all elements around it: a cut along faces that takes the node's neighbourhood
/// out of the body.
mesh::CutSurface around_node(const mesh::CutMesh& cut, std::int32_t node);

}  // namespace lancet::experiments::stability
