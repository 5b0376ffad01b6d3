#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "lancet/mesh/cut/polygon.hpp"

namespace lancet::mesh {

/// A triangle of a closed surface in the pool of an element: its plane, positive outside, the borders that stand on its
/// edges, positive inward, and the numbers of these edges in the surface.
struct PooledTriangle {
    std::int32_t triangle = 0;
    int plane = 0;
    std::array<int, 3> borders{};
    std::array<std::int32_t, 3> edges{};
};

/// A corner of a region: a point of the pool, and the edge of the surface on which it lies, or -1.
struct RegionCorner {
    int point = 0;
    std::int32_t edge = -1;
};
using Loop = std::vector<RegionCorner>;

/// The part of a convex polygon that lies inside of a closed surface, of which these are all triangles near the
/// polygon: loops with the region on their left, as the polygon runs counter-clockwise. Where the surface does not
/// cross the polygon's border, `is_border_inside` says where that lies.
///
/// Every triangle leaves a segment on the polygon. Segments are linked where they meet at an edge of the surface, and
/// along the polygon's border, on which segments that arrive and that start take turns. Nothing depends on rounding.
/// Nothing is returned where segments cannot be linked: the surface was not closed.
std::optional<std::vector<Loop>> inside_region(PlanePool& pool, const Polygon& polygon,
                                               std::span<const PooledTriangle> triangles,
                                               const std::function<bool()>& is_border_inside);

}  // namespace lancet::mesh
