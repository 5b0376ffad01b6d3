#pragma once

#include "lancet/mesh/surface/triangle_mesh.hpp"

namespace lancet::mesh::test {

/// A closed sphere of 8 * 4^levels triangles: an octahedron whose edges are halved, with vertices on the planes through
/// the centre.
TriangleMesh sphere(const Point& centre, double radius, int levels);

/// The box from the origin to `size`, of 12 triangles, closed.
TriangleMesh cuboid(const Point& origin, const Point& size);

/// A torus around the z axis of `around` * `across` * 2 triangles.
TriangleMesh torus(const Point& centre, double radius, double tube, int around, int across);

}  // namespace lancet::mesh::test
