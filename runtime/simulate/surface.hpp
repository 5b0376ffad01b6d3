#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lancet/mesh/cut/part_geometry.hpp"
#include "lancet/mesh/embed/embedded_surface.hpp"
#include "lancet/mesh/surface/vertex_normals.hpp"
#include "lancet/runtime/simulate/carried_points.hpp"
#include "lancet/runtime/simulate/snapshots.hpp"

namespace lancet::runtime {

/// What is solid of a body, for collisions: all pieces as tetrahedra, and their surface.
struct CarriedSolid {
    CarriedPoints points;
    std::vector<mesh::Tetrahedron> tetrahedra;  ///< of points
    std::vector<mesh::Triangle> triangles;      ///< of points, counter-clockwise as seen from outside
};

/// A surface of triangles that a body carries. Each vertex is a point of the material; where cuts open, vertices are
/// there once for each side, and the walls of cuts are triangles, too.
struct CarriedSurface {
    std::int64_t version = 0;  ///< another number, another surface
    CarriedPoints vertices;
    std::vector<mesh::Triangle> triangles;  ///< counter-clockwise as seen from outside
    std::vector<std::uint8_t> is_wall;      ///< [triangle] 1: a cut made it
    mesh::VertexCorners corners;
    std::shared_ptr<const CarriedSolid> solid;  ///< empty where nobody asks for it
};

/// A mean of up to four points of the material, such as a point of a triangle of a surface.
struct AttachedPoint {
    std::array<mesh::MaterialPoint, 4> corners{};
    std::array<double, 4> weights{1, 0, 0, 0};  ///< they add up to 1
};

/// The surface of a body at some time.
struct SurfaceShape {
    std::shared_ptr<const CarriedSurface> surface;
    std::int64_t step = 0;         ///< world steps that had been taken
    double time = 0;               ///< s
    std::vector<Point> positions;  ///< [vertex] metres
    std::vector<Point> normals;    ///< [vertex] of unit length, smooth (see mesh::vertex_normals)
};

/// The shapes of a body's surface. One slot more than others have: a frame holds a shape until the next one comes.
using SurfaceSnapshots = Snapshots<SurfaceShape, 6>;

/// The boundary of a mesh: every vertex is a node, every part an element.
CarriedSurface boundary_surface(const mesh::TetMesh& mesh);
/// That of a cut mesh, walls included.
CarriedSurface boundary_surface(const mesh::CutMesh& cut, const mesh::PartGeometry& geometry);
/// A fine surface as cuts have left it.
CarriedSurface carried_surface(const mesh::EmbeddedSurface& fine);
CarriedSolid carried_solid(const mesh::TetMesh& mesh);
CarriedSolid carried_solid(const mesh::CutMesh& cut, const mesh::PartGeometry& geometry);

/// Finds out how surfaces lie, one after the other.
class SurfaceEvaluator {
  public:
    /// Positions and normals from the places of the body's nodes. Allocates only where there are more than before.
    void evaluate(Scheduler& scheduler, const CarriedSurface& surface, std::span<const Point> nodes, SurfaceShape& out);

  private:
    std::vector<Point> corner_normals_;  ///< see mesh::corner_normals
};

}  // namespace lancet::runtime
