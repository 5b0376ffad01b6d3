#pragma once

#include <cstdint>

#include "lancet/mesh/generate/box.hpp"
#include "lancet/mesh/surface/triangle_mesh.hpp"

namespace lancet::mesh {

/// How coarse a mesh around a surface is.
struct AroundOptions {
    /// The edge of a cell, in the unit of the surface.
    double cell_size = 0;
    Split split = Split::five;
    /// A grid of more cells than this around the surface is refused.
    std::int64_t most_cells = 20'000'000;
};

/// Meshes what a closed surface encloses by the cells of a cubic grid that touch the inside, so that all of the surface
/// lies in the mesh: to be carried by it (Jerabkova 2007, section 4.1). The grid is centred at the box around the
/// surface. A surface of one piece gives a mesh of one piece (see components.hpp); pieces and folds that are closer
/// than a cell grow together. Cells cut by the surface are full: a body is up to a cell thicker than its surface.
/// @throws lancet::Error for a surface that is not closed, a cell size that is not positive and finite, and more cells
/// than allowed.
TetMesh around(const TriangleMesh& surface, const AroundOptions& options);

}  // namespace lancet::mesh
