#pragma once

#include "lancet/experiments/stability/random.hpp"
#include "lancet/mesh/tet_mesh.hpp"
#include "lancet/runtime/simulate/scene.hpp"

namespace lancet::experiments::stability {

/// What meshes and scenes are made of, from a seed.

/// The quality of a tetrahedron: 6 sqrt(2) V / l^3 with l its longest edge. It is 1 for the regular one and falls in
/// proportion to the height of a flat one.
double quality(const mesh::TetMesh& mesh, std::int32_t element);
double lowest_quality(const mesh::TetMesh& mesh);
/// The smallest height of a tetrahedron over its longest edge.
double height_over_edge(const mesh::TetMesh& mesh, std::int32_t element);

/// Moves one node towards the opposite face of one of its elements until that one has about this quality, and all
/// others are still valid. Tries elements at random; where none gives way, the mesh stays as it is.
mesh::TetMesh with_bad_element(const mesh::TetMesh& mesh, double quality, Random& random);

/// A body of some dozens to some hundreds of elements: a box of five or six tetrahedra to a cell or a cylinder; its
/// nodes moved at random, or stretched up to a hundred times along an axis, or with one element of a quality down to
/// 1e-6, or as it is; from millimetres to metres long, sometimes a hundred metres from the origin.
mesh::TetMesh random_mesh(Random& random);

/// The scene of a mesh under gravity: a random elastic material, held at its end of lowest x, at one of its nodes, or
/// not at all.
runtime::Scene random_scene(mesh::TetMesh mesh, Random& random);

/// Nodes of the lowest x and of the highest x.
std::vector<std::int32_t> nodes_at_end(const mesh::TetMesh& mesh, bool highest);

/// The length of the diagonal of the box around a mesh.
double size_of(const mesh::TetMesh& mesh);

}  // namespace lancet::experiments::stability
