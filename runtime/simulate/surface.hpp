#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lancet/kernels/isa/instruction_set.hpp"
#include "lancet/kernels/layout/vertex_rings.hpp"
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
    kernels::VertexRings rings;
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
    /// [vertex] of unit length, smooth: as mesh::vertex_normals, to what float makes of them (see NormalKernels).
    std::vector<Point> normals;
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

/// Finds the normals of surfaces, one after the other.
class SurfaceEvaluator {
  public:
    explicit SurfaceEvaluator(kernels::InstructionSet instruction_set = kernels::active_instruction_set());

    /// From the positions of the same shape. Allocates only where there are more than before.
    void find_normals(Scheduler& scheduler, const CarriedSurface& surface, SurfaceShape& shape);

  private:
    kernels::NormalKernels kernels_;
    std::vector<std::uint16_t> doubtful_;  ///< see VertexNormalArguments
};

}  // namespace lancet::runtime
