#pragma once

#include <functional>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "lancet/mesh/embed/element_patch.hpp"
#include "lancet/mesh/embed/inside_region.hpp"

namespace lancet::mesh {

/// Brings triangles of a surface and polygons of a pool together, and collects what comes out as a patch.
class PatchBuilder {
  public:
    /// Where points of the pool are: the corners of its tetrahedron at rest.
    PatchBuilder(PlanePool pool, const std::array<Point, 4>& at_rest) : pool_(std::move(pool)), at_rest_(at_rest) {}

    PlanePool& pool() noexcept { return pool_; }

    /// Takes a triangle in; nothing where it does not touch the tetrahedron.
    const PooledTriangle* add_triangle(SurfaceFacets& facets, std::int32_t triangle);

    /// The number of a point as a corner of a part's polygons, always the same.
    std::int32_t corner(std::int32_t part, int point, const Barycentric& weights, std::int32_t vertex,
                        std::int32_t edge);

    /// A side of a wall: its part, and the corners of its element that are those of the pool's tetrahedron.
    struct Side {
        std::int32_t part = 0;
        std::array<int, 4> corners{0, 1, 2, 3};
    };
    /// The inside of a polygon as a wall of the part that it is seen counter-clockwise from outside of, and of the one
    /// behind. All triangles must have been added.
    void add_wall(const Polygon& polygon, const Side& front, const Side& back,
                  const std::function<bool(const Point&)>& is_inside);

    ElementPatch& patch() noexcept { return patch_; }

  private:
    Point place_at_rest(int point) const;

    PlanePool pool_;
    std::array<Point, 4> at_rest_;
    std::vector<CutSurface> kept_;  ///< which the pool refers to
    std::vector<PooledTriangle> triangles_;
    std::map<std::pair<std::int32_t, int>, std::int32_t> numbers_;
    ElementPatch patch_;
};

}  // namespace lancet::mesh
