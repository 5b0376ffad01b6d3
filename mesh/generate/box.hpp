#pragma once

#include <array>

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh {

/// How a cell of a box is cut into tetrahedra.
enum class Split {
    /// Five: one in the middle (1/3 of the cell) and four at corners (1/6 each), mirrored from cell to cell.
    five,
    /// Six equal ones around the diagonal, the same in every cell (Kuhn's subdivision).
    six
};

/// A box of equal cells along the axes.
struct Box {
    std::array<int, 3> cells{1, 1, 1};
    std::array<double, 3> size{1, 1, 1};
    Split split = Split::five;
    /// The corner of lowest coordinates.
    Point origin{0, 0, 0};
    /// Five elements to a cell: the cells of even and of odd i + j + k change places.
    bool swap_parity = false;
};

/// Meshes a box. Node (i, j, k) has the number i + (nx + 1) (j + (ny + 1) k); elements follow the cells, i fastest.
/// With five elements to a cell, cells of even i + j + k have the tetrahedron 3, 5, 6, 0 of the corners numbered
/// x + 2 y + 4 z in the middle, the others 1, 2, 4, 7. The six sides are node sets x_min, x_max, ... z_max.
/// @throws lancet::Error for cells below 1, sizes that are not positive and finite, and more nodes or elements than
/// 32-bit numbers count.
TetMesh box(const Box& box);

}  // namespace lancet::mesh
