#pragma once

#include <array>
#include <span>

#include "lancet/mesh/generate/box.hpp"

namespace lancet::mesh {

/// Corners of a tetrahedron among those of a cell, numbered x + 2 y + 4 z.
using CellCorners = std::array<int, 4>;

/// The tetrahedra of a cell, of positive volume. Cells that share a face fit together where even and odd ones take
/// turns; for six to a cell both are the same.
std::span<const CellCorners> cell_tetrahedra(Split split, bool is_even);

}  // namespace lancet::mesh
