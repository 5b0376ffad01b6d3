#pragma once

#include <span>

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh {

/// What triangles add to the normals of their corners: normals[3 t + k] becomes the unit normal of triangle t times its
/// angle at its k-th corner, in radians. Zero for a triangle without an area, or with a corner that is not finite.
///
/// With the edges u and v of the triangle that are not the longest, n = u x v is as exact as the differences of the
/// positions are, for needles too. The two smaller angles are atan2(|n|, d), d being the scalar product of the edges at
/// the corner, to a few roundings of their own size; the largest is what they leave of pi.
///
/// `positions` are of all vertices, `normals` of the corners of these triangles. Nothing is allocated, and what becomes
/// of a triangle does not depend on its neighbours in the span: blocks of triangles may run at the same time.
void corner_normals(std::span<const Triangle> triangles, std::span<const Point> positions, std::span<Point> normals);

}  // namespace lancet::mesh
