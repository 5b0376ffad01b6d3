#pragma once

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::experiments {

/// A closed body of the shape of an organ, 0.2 m long, about 0.1 m wide and 0.07 m thick: a rod whose cross-sections
/// are ellipses that taper towards one end, with bulging ends, bent and with one thin edge. 18 n^2 m elements for n
/// rings of elements around the axis and m layers along it.
[[nodiscard]] mesh::TetMesh organ_mesh(int rings, int layers);

}  // namespace lancet::experiments
