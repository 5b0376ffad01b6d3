#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lancet/mesh/cut/part_moments.hpp"
#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh {

/// Points bound to the elements that carry them: the place of point p is sum_k weights[p][k] x(node k of elements[p])
/// (Jerabkova 2007, section 4.1.1).
struct Embedding {
    std::vector<std::int32_t> elements;
    /// Barycentric coordinates at rest; they add up to one, so that affine motions carry points exactly.
    std::vector<Barycentric> weights;
    /// From the element, in metres at rest: zero inside.
    std::vector<double> distances;
};

/// Binds points, given at rest, to the element that contains them; a point on a border to one beside. What lies outside
/// of the mesh is bound to the nearest element, the lowest of several, and goes on with its motion behind its faces:
/// far outside of thin elements that exaggerates. Takes time linear in points and elements where elements are of
/// similar size.
/// @throws lancet::Error for a mesh without elements and for points that are not finite.
Embedding embed(const TetMesh& mesh, std::span<const Point> points);

/// Where a point is: sum_k weights[k] positions[nodes[k]].
inline Point place(const Tetrahedron& nodes, const Barycentric& weights, std::span<const Point> positions) {
    const Point &a = positions[static_cast<std::size_t>(nodes[0])], &b = positions[static_cast<std::size_t>(nodes[1])],
                &c = positions[static_cast<std::size_t>(nodes[2])], &d = positions[static_cast<std::size_t>(nodes[3])];
    Point at;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        at[axis] = (weights[0] * a[axis] + weights[1] * b[axis]) + (weights[2] * c[axis] + weights[3] * d[axis]);
    }
    return at;
}

/// Where points are: places[p] = sum_k weights[p][k] positions[nodes[p][k]]. Nothing is allocated; blocks of points are
/// parts of the spans, and may run at the same time. The first three must have the same length, and nodes numbers of
/// positions.
void place(std::span<const Tetrahedron> nodes, std::span<const Barycentric> weights, std::span<const Point> positions,
           std::span<Point> places);

}  // namespace lancet::mesh
