#include "lancet/mesh/cut/polygon.hpp"

#include <algorithm>
#include <utility>

namespace lancet::mesh {

Polygon clip(PlanePool& pool, const Polygon& polygon, const HalfSpace& half) {
    const std::size_t count = polygon.points.size();
    std::vector<int> sides(count);
    for (std::size_t k = 0; k < count; ++k) sides[k] = half.side * pool.side(half.plane, polygon.points[k]);
    const auto [lowest, highest] = std::ranges::minmax(sides);
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

bool are_joined(PlanePool& pool, const Polygon& a, const Polygon& b, std::span<const Cover> covers) {
    Polygon shared = a;
    for (const HalfSpace& edge : b.edges) {
        shared = clip(pool, shared, edge);
        if (shared.points.empty()) return false;
    }
    std::vector<Polygon> open{std::move(shared)};
    for (const Cover& cover : covers) {
        const bool lies_in_plane =
            std::ranges::all_of(open.front().points, [&](int point) { return pool.side(cover.plane, point) == 0; });
        if (!lies_in_plane) continue;
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
