#include "lancet/mesh/embed/patch_builder.hpp"

#include <algorithm>

namespace lancet::mesh {

const PooledTriangle* PatchBuilder::add_triangle(SurfaceFacets& facets, std::int32_t triangle) {
    const CutSurface& surface = facets.facet(triangle);
    const Facet& facet = surface.facets().front();
    if (!may_touch(facet, at_rest_)) return nullptr;
    PooledTriangle pooled{.triangle = triangle, .edges = facets.edges_of(triangle)};
    pooled.plane = pool_.add_plane(facet.plane, at_rest_);
    for (std::size_t k = 0; k < 3; ++k) pooled.borders[k] = pool_.add_plane(facet.borders[k].plane, at_rest_);
    kept_.push_back(surface);
    return &triangles_.emplace_back(pooled);
}

std::int32_t PatchBuilder::corner(std::int32_t part, int point, const Barycentric& weights, std::int32_t vertex,
                                  std::int32_t edge) {
    const auto [place, is_new] = numbers_.try_emplace({part, point}, 0);
    if (is_new) {
        place->second = static_cast<std::int32_t>(patch_.corners.size());
        patch_.corners.push_back({part, weights, vertex, edge});
    }
    return place->second;
}

Point PatchBuilder::place_at_rest(int point) const {
    Point place{};
    const Barycentric& weights = pool_.coordinates(point);
    for (std::size_t k = 0; k < 4; ++k) {
        for (std::size_t axis = 0; axis < 3; ++axis) place[axis] += weights[k] * at_rest_[k][axis];
    }
    return place;
}

void PatchBuilder::add_wall(const Polygon& polygon, const Side& front, const Side& back,
                            const std::function<bool(const Point&)>& is_inside) {
    const auto is_border_inside = [&] {
        // All corners are on one side; one that is close to the surface may be misjudged.
        const auto inside = std::ranges::count_if(polygon.points, [&](int p) { return is_inside(place_at_rest(p)); });
        return 2 * static_cast<std::size_t>(inside) > polygon.points.size();
    };
    const auto loops = inside_region(pool_, polygon, triangles_, is_border_inside);
    if (!loops || loops->empty()) return;
    for (const Side* side : {&front, &back}) {
        ElementPatch::Polygon& wall = patch_.polygons.emplace_back();
        wall.part = side->part;
        for (const Loop& loop : *loops) {
            std::vector<std::int32_t>& numbers = wall.loops.emplace_back();
            for (const RegionCorner& at : loop) {
                const Barycentric& here = pool_.coordinates(at.point);
                Barycentric weights{};
                for (std::size_t k = 0; k < 4; ++k) weights[static_cast<std::size_t>(side->corners[k])] = here[k];
                numbers.push_back(corner(side->part, at.point, weights, -1, at.edge));
            }
            if (side == &back) std::ranges::reverse(numbers);
        }
    }
}

}  // namespace lancet::mesh
