#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/mesh/embed/surface_facets.hpp"

namespace lancet::mesh {

/// What an element and its parts have of a surface, and of the walls inside of it; or the walls along a face.
struct ElementPatch {
    /// A corner of polygons, with the part that carries it.
    struct Corner {
        std::int32_t part = 0;
        Barycentric weights{};
        std::int32_t vertex = -1;  ///< of the surface, where it is one
        std::int32_t edge = -1;    ///< of the surface, where it lies on one
    };
    struct Polygon {
        std::int32_t part = 0;
        std::int32_t triangle = -1;  ///< of the surface; -1: a wall
        /// Numbers of corners: counter-clockwise as seen from outside of the piece, clockwise around holes.
        std::vector<std::vector<std::int32_t>> loops{};
    };
    std::vector<Corner> corners;
    std::vector<Polygon> polygons;
};

/// Whether a place is inside of the closed surface.
using Inside = std::function<bool(const Point&)>;

/// The pieces of triangles in the cells of an element and, with `is_inside`, the walls: what lies inside of the surface
/// of the sections between parts with different copies. The triangles must be all that come near the element for
/// walls. Everything is decided exactly (see SurfaceFacets).
ElementPatch element_patch(const CutMesh& cut, std::int32_t element, SurfaceFacets& facets,
                           std::span<const std::int32_t> triangles, const Inside& is_inside = {});

/// The walls along the face between two elements, the first of which a cut has touched: what lies inside of the surface
/// where parts on both sides of the face have different copies at its corners. The triangles must be all that come near
/// the face.
ElementPatch face_patch(const CutMesh& cut, std::int32_t element, std::int32_t neighbour, SurfaceFacets& facets,
                        std::span<const std::int32_t> triangles, const Inside& is_inside);

}  // namespace lancet::mesh
