#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/mesh/embed/element_patch.hpp"
#include "lancet/mesh/embed/loop_mending.hpp"
#include "lancet/mesh/embed/surface_facets.hpp"
#include "lancet/mesh/surface/box_grid.hpp"
#include "lancet/mesh/surface/inside_test.hpp"

namespace lancet::mesh {

/// A fine surface that a mesh of coarse elements carries, and that opens where the mesh is cut (Jerabkova 2007,
/// sections 4.1.1 to 4.1.3).
///
/// Each vertex is a point of the material: its place is a mean of the places of four copies of nodes,
///
///     place(copies(), weights(), positions, places);   vertex_normals(corners, places, begin, end, normals);
///
/// both over blocks of vertices, without allocations, from any snapshot of the positions.
///
/// Where a cut touches elements, their triangles are divided at the borders of parts, vertices on the cut are doubled,
/// and what the cut has opened inside of a closed surface becomes a wall. For a closed surface that lies inside of the
/// mesh this is guaranteed, in whatever way it is cut: the surface is a boundary (SurfaceTopology::is_boundary): every
/// side of a triangle is opposite to another one, without corners in the middle of sides. So each piece of the body has
/// a closed surface of its own, and the places of pieces whose copies are all different have no vertex in common. At
/// the front of a cut both walls share the vertices; along such lines, and where pieces touch in lines or points only,
/// a side may have four triangles. Distances below 2^-24 of an element's size do not count: vertices that close are
/// one, and pieces that thin have no inside.
///
/// Vertices keep their numbers, also where no triangle uses one any more; numbers of triangles change with the
/// topology. Clipping, which takes most of the time, is done anew only in elements that a cut has touched or near which
/// it has separated copies; putting together what it makes takes time proportional to all that has been cut so far.
///
/// Not followed: triangles that leave the mesh (they are not divided, and the wall has a gap there); copies that open
/// in blended fronts (lanes.hpp: the surface there is that of sharp fronts, and opens when the front has passed); walls
/// of an open surface. Where the surface is the boundary of the mesh itself, part_geometry.hpp has the exact answer.
class EmbeddedSurface {
  public:
    /// Binds a surface, given at rest, and follows the cuts that there are.
    /// @throws lancet::Error for an invalid surface, edges of more than two triangles, and vertices outside of the
    /// mesh.
    EmbeddedSurface(const CutMesh& cut, TriangleMesh surface);

    /// Follows further cuts of the same mesh. Returns true where anything has changed; the spans are others then.
    /// @throws lancet::Error for another mesh.
    bool update(const CutMesh& cut);

    /// Counts the changes: what is derived from triangles and vertices is to be renewed with it.
    std::uint64_t topology_version() const noexcept { return version_; }
    std::span<const Triangle> triangles() const noexcept { return triangles_; }
    /// [triangle] 1: a cut made it, 0: it is of the surface.
    std::span<const std::uint8_t> is_wall() const noexcept { return is_wall_; }
    std::span<const MaterialPoint> points() const noexcept { return points_; }
    /// The copies of nodes that carry each vertex, and their weights.
    std::span<const Tetrahedron> copies() const noexcept { return copies_; }
    std::span<const Barycentric> weights() const noexcept { return weights_; }
    /// Vertices at rest.
    std::span<const Point> at_rest() const noexcept { return at_rest_; }

  private:
    struct Patch {
        ElementPatch shape{};
        std::vector<std::int32_t> numbers{};  ///< of vertices, for each corner; -1: not yet
        bool has_all = false;                 ///< all triangles near it, and walls
    };
    void renew(const CutMesh& cut, std::int32_t element, bool has_all);
    void renew_face(const CutMesh& cut, std::int32_t element, std::int32_t beside);
    void replace(std::pair<std::int32_t, std::int32_t> elements, ElementPatch shape, bool has_all);
    std::vector<std::int32_t> state_of(const CutMesh& cut, std::int32_t element) const;
    std::vector<std::int32_t> triangles_near(std::int32_t element) const;
    void assemble(const CutMesh& cut);
    void number_corners(const CutMesh& cut);
    void set_point(const CutMesh& cut, std::int32_t vertex, const MaterialPoint& point);
    std::vector<PartRegion> regions() const;
    void add_undivided(std::vector<PartRegion>& all);
    void find_leaving(const CutMesh& cut, const std::set<std::int32_t>& triangles);

    SurfaceFacets facets_;
    std::optional<InsideTest> inside_;
    BoxGrid triangle_grid_, element_grid_;
    std::vector<Bounds> element_boxes_, triangle_boxes_;
    std::vector<std::array<std::int32_t, 4>> neighbours_;
    std::size_t elements_ = 0;

    std::map<std::int32_t, std::vector<std::int32_t>> states_;  ///< of touched elements, when their patches were made
    /// Of elements, twice the same number, and of faces, those on both sides.
    std::map<std::pair<std::int32_t, std::int32_t>, Patch> patches_;
    std::vector<std::uint8_t> is_divided_, leaves_;  ///< [triangle of the surface]
    std::uint64_t version_ = 0;
    std::vector<Triangle> triangles_;
    std::vector<std::uint8_t> is_wall_;
    std::vector<MaterialPoint> points_;
    std::vector<Tetrahedron> copies_;
    std::vector<Barycentric> weights_;
    std::vector<Point> at_rest_;
};

}  // namespace lancet::mesh
