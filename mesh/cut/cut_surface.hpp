#pragma once

#include <array>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh {

struct Facet;

/// A surface along which a body is cut: flat facets, each bounded by straight borders or not at all. Facets that share
/// an edge with equal end points leave no gap. A copy shares its facets, which do not change.
///
/// Every maker throws lancet::Error for numbers that are not finite and for figures without an area or a direction.
class CutSurface {
  public:
    /// The whole plane through `point`.
    static CutSurface plane(const Point& point, const Point& normal);
    /// The half of a plane on one side of a straight border through `point`: towards `inward`, a direction that is not
    /// along the normal.
    static CutSurface half_plane(const Point& point, const Point& normal, const Point& inward);
    /// The parallelogram with a corner and the two edges from there.
    static CutSurface parallelogram(const Point& corner, const Point& first_edge, const Point& second_edge);
    /// Triangles; `triangles` are numbers of `vertices`. Triangles without an area are left out, unless all are.
    static CutSurface triangulated(std::span<const Point> vertices, std::span<const Triangle> triangles);
    /// What a straight blade sweeps: its places are segments {heel, tip}, one after the other.
    static CutSurface swept(std::span<const std::array<Point, 2>> places);
    /// Where a function of the place is zero. Within an element it is taken as linear between the nodes. A cut throws
    /// lancet::Error where its value at a node is not finite.
    static CutSurface level_set(std::function<double(const Point&)> function);

    std::span<const Facet> facets() const noexcept;
    /// What keeps the facets alive.
    const std::shared_ptr<const std::vector<Facet>>& shared_facets() const noexcept { return facets_; }

  private:
    explicit CutSurface(std::vector<Facet> facets);
    std::shared_ptr<const std::vector<Facet>> facets_;
};

}  // namespace lancet::mesh
