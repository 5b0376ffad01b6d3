#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh {

/// A surface of triangles, closed or open. Triangles are counter-clockwise as seen from outside, where there is one.
struct TriangleMesh {
    std::vector<Point> vertices{};
    std::vector<Triangle> triangles{};
};

/// How the triangles of a surface hang together at their edges. Triangles with a repeated vertex count for nothing.
struct SurfaceTopology {
    std::int64_t border_edges = 0;     ///< of one triangle
    std::int64_t overused_edges = 0;   ///< of three and more triangles
    std::int64_t unmatched_edges = 0;  ///< directed edges without an opposite one, each as often as it has none
    std::int64_t empty_triangles = 0;  ///< with a repeated vertex
    bool is_orientable = true;         ///< triangles could be turned so that neighbours agree across edges of two

    /// Every edge has two triangles.
    bool is_closed() const { return border_edges == 0 && overused_edges == 0; }
    /// The surface bounds something: every directed edge occurs as often as the opposite one, also where several
    /// sheets share an edge.
    bool is_boundary() const { return unmatched_edges == 0; }
};

/// Time n log n. @throws lancet::Error for a triangle with a vertex that does not exist.
SurfaceTopology surface_topology(std::size_t vertices, std::span<const Triangle> triangles);

/// The volume that a closed surface encloses: positive where its triangles are counter-clockwise as seen from outside.
/// That of an open surface is meaningless.
double signed_volume(std::span<const Point> vertices, std::span<const Triangle> triangles);
/// The area of all triangles.
double area(std::span<const Point> vertices, std::span<const Triangle> triangles);
/// The smallest box around points, lower and upper corner. Both zero where there are none.
std::array<Point, 2> bounds(std::span<const Point> points);

/// Throws lancet::Error, which begins with `what`, for a vertex that is not finite and for a triangle with a vertex
/// that does not exist.
void require_valid(const char* what, std::span<const Point> vertices, std::span<const Triangle> triangles);

}  // namespace lancet::mesh
