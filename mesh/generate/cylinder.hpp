#pragma once

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh {

/// A solid round rod.
struct Cylinder {
    double length = 1;
    double radius = 0.25;
    int cells_along = 8;
    /// Cells from the axis to the surface.
    int cells_across = 2;
    /// The direction of the rod: 0, 1, 2 for x, y, z.
    int axis = 2;
    /// The centre of the end of lowest coordinate.
    Point origin{0, 0, 0};
};

/// Meshes a rod: 6 n^2 triangles in a cross section of n = cells_across rings (six radial sectors, ring r carries 6 r
/// nodes), drawn out to prisms of three tetrahedra: 18 n^2 cells_along elements. The outermost nodes lie on the
/// cylinder, so the volume tends to pi r^2 l from below, as 3 n sin(pi / (3 n)) r^2 l. Elements are best shaped where
/// length / cells_along is near radius / cells_across. Nodes are numbered section by section from the axis outward;
/// the node sets are start, end (the two flat ends) and side (the round surface).
/// @throws lancet::Error for sizes that are not positive and finite, cells below 1, an axis other than 0, 1, 2, and
/// more nodes or elements than 32-bit numbers count.
TetMesh cylinder(const Cylinder& cylinder);

}  // namespace lancet::mesh
