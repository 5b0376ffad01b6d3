#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/mesh/surface/vertex_normals.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::runtime {

using mesh::Point;

/// A surface of triangles that a body carries. Each vertex is a point of the material; where cuts open, vertices are
/// there once for each side, and the walls of cuts are triangles, too.
struct CarriedSurface {
    std::int64_t version = 0;                ///< another number, another surface
    std::vector<std::int32_t> parts;         ///< [vertex] that carry it; of a mesh without cuts the elements
    std::vector<mesh::Tetrahedron> nodes;    ///< [vertex] of the body: those of the part
    std::vector<mesh::Barycentric> weights;  ///< [vertex] of them
    std::vector<mesh::Triangle> triangles;   ///< counter-clockwise as seen from outside
    std::vector<std::uint8_t> is_wall;       ///< [triangle] 1: a cut made it
    mesh::VertexCorners corners;
};

/// A point of a triangle of a surface: three points of the material with weights that add up to 1.
struct SurfacePoint {
    std::array<mesh::MaterialPoint, 3> corners{};
    std::array<double, 3> weights{1, 0, 0};
};

/// The surface of a body at some time.
struct SurfaceShape {
    std::shared_ptr<const CarriedSurface> surface;
    std::int64_t step = 0;         ///< world steps that had been taken
    double time = 0;               ///< s
    std::vector<Point> positions;  ///< [vertex] metres
    std::vector<Point> normals;    ///< [vertex] of unit length, smooth (see mesh::vertex_normals)
};

/// The boundary of a mesh: every vertex is a node, every part an element.
CarriedSurface boundary_surface(const mesh::TetMesh& mesh);
/// That of a cut mesh, walls included.
CarriedSurface boundary_surface(const mesh::CutMesh& cut);

/// Finds the places of vertices from those of the body's nodes; allocates only where the surface has grown.
void place(Scheduler& scheduler, const CarriedSurface& surface, std::span<const Point> nodes, std::vector<Point>& out);
/// Positions and normals.
void evaluate(Scheduler& scheduler, const CarriedSurface& surface, std::span<const Point> nodes, SurfaceShape& out);

}  // namespace lancet::runtime
