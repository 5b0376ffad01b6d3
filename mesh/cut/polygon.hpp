#pragma once

#include <span>
#include <vector>

#include "lancet/mesh/cut/inline_vector.hpp"
#include "lancet/mesh/cut/plane_pool.hpp"

namespace lancet::mesh {

/// One side of a plane of a pool: where its function has the sign `side`.
struct HalfSpace {
    int plane = 0;
    int side = 1;  ///< +1 or -1
};

/// Numbers of points around a polygon, and the half-spaces behind its edges: few, and kept in place.
using PointNumbers = InlineVector<int, 8>;
using HalfSpaces = InlineVector<HalfSpace, 8>;

/// A convex polygon in a plane of a pool. Edge k runs from point k to the next and lies on the border of half-space k,
/// inside of which is the polygon.
struct Polygon {
    int plane = 0;
    PointNumbers points{};
    HalfSpaces edges{};
};

/// A figure without gaps that may cover part of a polygon: where the plane's function is zero and no border's negative.
struct Cover {
    int plane = 0;
    std::vector<int> borders{};
};

/// The part of a polygon in a half-space; no points where it has no area.
Polygon clip(PlanePool& pool, const Polygon& polygon, const HalfSpace& half);

/// A polygon, or a face of a cell, that is looked at.
struct PolygonView {
    int plane = 0;
    std::span<const int> points{};
    std::span<const HalfSpace> edges{};

    PolygonView(const Polygon& polygon) : plane(polygon.plane), points(polygon.points), edges(polygon.edges) {}
    PolygonView(int in_plane, std::span<const int> with_points, std::span<const HalfSpace> with_edges)
        : plane(in_plane), points(with_points), edges(with_edges) {}
};

/// True where two polygons of one plane share an area that no cover hides.
bool are_joined(PlanePool& pool, const PolygonView& a, const PolygonView& b, std::span<const Cover> covers);

}  // namespace lancet::mesh
