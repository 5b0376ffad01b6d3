#include "lancet/mesh/cut/polygon.hpp"

#include <algorithm>
#include <utility>

namespace lancet::mesh {

Polygon clip(PlanePool& pool, const Polygon& polygon, const HalfSpace& half) {
    const std::size_t count = polygon.points.size();
    PointNumbers sides(count);
    int lowest = 1, highest = -1;
    for (std::size_t k = 0; k < count; ++k) {
        sides[k] = half.side * pool.side(half.plane, polygon.points[k]);
        lowest = std::min(lowest, sides[k]);
        highest = std::max(highest, sides[k]);
    }
    if (highest <= 0) return {.plane = polygon.plane};
    if (lowest >= 0) return polygon;

    Polygon inside{.plane = polygon.plane};
    for (std::size_t k = 0; k < count; ++k) {
        const int here = sides[k], there = sides[(k + 1) % count];
        if (here >= 0) {
            inside.points.push_back(polygon.points[k]);
            // From a point on the border to the outside runs the border itself.
            inside.edges.push_back(here == 0 && there < 0 ? half : polygon.edges[k]);
        }
        if (here * there < 0) {
            inside.points.push_back(pool.add_point({polygon.plane, polygon.edges[k].plane, half.plane}));
            inside.edges.push_back(here > 0 ? half : polygon.edges[k]);
        }
    }
    return inside;
}

namespace {

/// True where one of the edges of a polygon has all of the other on its outer side. Of convex polygons in one plane
/// that share no area, an edge of one of them separates both.
bool is_separated_by_an_edge(const PlanePool& pool, const PolygonView& polygon, const PolygonView& other) {
    return std::ranges::any_of(polygon.edges, [&](const HalfSpace& edge) {
        return std::ranges::none_of(other.points,
                                    [&](int point) { return edge.side * pool.side(edge.plane, point) > 0; });
    });
}

bool lies_in(const PlanePool& pool, const PolygonView& polygon, int plane) {
    return std::ranges::all_of(polygon.points, [&](int point) { return pool.side(plane, point) == 0; });
}

}  // namespace

bool are_joined(PlanePool& pool, const PolygonView& a, const PolygonView& b, std::span<const Cover> covers) {
    if (is_separated_by_an_edge(pool, a, b) || is_separated_by_an_edge(pool, b, a)) return false;
    std::vector<Polygon> open;
    for (const Cover& cover : covers) {
        if (!lies_in(pool, a, cover.plane)) continue;
        if (open.empty()) {
            open.push_back({a.plane, {a.points.begin(), a.points.end()}, {a.edges.begin(), a.edges.end()}});
            for (const HalfSpace& edge : b.edges) open.front() = clip(pool, open.front(), edge);
        }
        std::vector<Polygon> left;
        for (Polygon& piece : open) {
            for (const int border : cover.borders) {
                Polygon outside = clip(pool, piece, {border, -1});
                if (!outside.points.empty()) left.push_back(std::move(outside));
                piece = clip(pool, piece, {border, 1});
                if (piece.points.empty()) break;
            }
        }
        open = std::move(left);
        if (open.empty()) return false;
    }
    return true;
}

}  // namespace lancet::mesh
