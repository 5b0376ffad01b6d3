#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lancet/mesh/surface/triangle_mesh.hpp"

namespace lancet::mesh {

/// The corners of triangles around each vertex, made once for each topology: corner 3 t + k is the k-th of triangle t.
class VertexCorners {
  public:
    VertexCorners() = default;
    /// Takes over the triangles. Time and memory are linear.
    /// @throws lancet::Error for a triangle with a vertex that does not exist.
    VertexCorners(std::size_t vertices, std::span<const Triangle> triangles);

    std::size_t vertices() const noexcept { return first_.empty() ? 0 : first_.size() - 1; }
    std::span<const Triangle> triangles() const noexcept { return triangles_; }
    std::span<const std::int32_t> of(std::size_t vertex) const { return of(vertex, vertex + 1); }
    /// Those of the vertices [begin, end), one vertex after the other.
    std::span<const std::int32_t> of(std::size_t begin, std::size_t end) const {
        return std::span(corners_).subspan(first_[begin], first_[end] - first_[begin]);
    }

  private:
    std::vector<Triangle> triangles_;
    std::vector<std::size_t> first_;
    std::vector<std::int32_t> corners_;
};

/// Unit normals of the vertices [begin, end): the normals of the triangles around, weighted by their angles there.
///
/// Weighted by angles, a normal depends on the surface and not on how it is divided into triangles: dividing a
/// triangle, as cuts do, does not change it; weights by area would. A triangle without an area, or with a corner that
/// is not finite, counts for nothing, and where nothing counts the normal is zero.
///
/// `positions` and `normals` are of all vertices. Each vertex is written by its own block alone and nothing is
/// allocated: blocks may run at the same time.
///
/// This evaluates each triangle once for each of its corners. Where there is room for three points per triangle, the
/// same normals, to the bit, come from corner_normals over blocks of triangles and then add_corner_normals over blocks
/// of vertices, in a third of the time.
void vertex_normals(const VertexCorners& corners, std::span<const Point> positions, std::size_t begin, std::size_t end,
                    std::span<Point> normals);

/// The same from what corner_normals has found for all triangles.
void add_corner_normals(const VertexCorners& corners, std::span<const Point> corner_normals, std::size_t begin,
                        std::size_t end, std::span<Point> normals);

}  // namespace lancet::mesh
