#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lancet/mesh/cut/part_geometry.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::runtime {

using mesh::Point;

/// Points that a body carries: each is a point of the material.
class CarriedPoints {
  public:
    std::vector<std::int32_t> parts;         ///< [point] that carry it; of a mesh without cuts the elements
    std::vector<mesh::Tetrahedron> nodes;    ///< [point] of the body: those of the part
    std::vector<mesh::Barycentric> weights;  ///< [point] of them

    std::size_t size() const noexcept { return parts.size(); }
    /// [point] the node that it is; empty where a point is none.
    std::span<const std::int32_t> as_nodes() const noexcept { return as_nodes_; }
    void add(const mesh::MaterialPoint& point, const mesh::Tetrahedron& of_part);

    /// Finds the places of points from those of the body's nodes: sum_k weights[p][k] positions[nodes[p][k]]. Points
    /// that are nodes are copied, those on edges are means of two. Allocates only where there are more than before.
    void place(Scheduler& scheduler, std::span<const Point> positions, std::vector<Point>& places) const;

  private:
    struct OnNode {
        std::int32_t point, node;
    };
    struct OnEdge {
        std::int32_t point;
        std::array<std::int32_t, 2> nodes;
        std::array<double, 2> weights;
    };
    // All points, by what they hang on: so that loops have no branches.
    std::vector<OnNode> on_nodes_;
    std::vector<OnEdge> on_edges_;
    std::vector<std::int32_t> inside_;  ///< of faces and elements
    std::vector<std::int32_t> as_nodes_;
};

}  // namespace lancet::runtime
