#pragma once

#include <span>
#include <vector>

#include "lancet/mesh/cut/plane_pool.hpp"

namespace lancet::mesh {

/// One side of a plane of a pool: where its function has the sign `side`.
struct HalfSpace {
    int plane = 0;
    int side = 1;  ///< +1 or -1
};

/// A convex polygon in a plane of a pool. Edge k runs from point k to the next and lies on the border of half-space k,
/// inside of which is the polygon.
struct Polygon {
    int plane = 0;
    std::vector<int> points{};
    std::vector<HalfSpace> edges{};
};

/// A figure without gaps that may cover part of a polygon: where the plane's function is zero and no border's negative.
struct Cover {
    int plane = 0;
    std::vector<int> borders{};
};

/// The part of a polygon in a half-space; no points where it has no area.
Polygon clip(PlanePool& pool, const Polygon& polygon, const HalfSpace& half);

/// True where two polygons of one plane share an area that no cover hides.
bool are_joined(PlanePool& pool, const Polygon& a, const Polygon& b, std::span<const Cover> covers);

}  // namespace lancet::mesh
