#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lancet/runtime/collide/broad_phase.hpp"

namespace lancet::runtime {

/// What contacts of a body are found with: its tetrahedra and its surface, a snapshot of where its nodes are, and the
/// broad phases over both. For a cut body the tetrahedra and triangles are those of its parts (mesh::PartGeometry), and
/// its nodes the points there.
class CollidableBody {
  public:
    /// `surface`: counter-clockwise as seen from outside. Nodes that no tetrahedron uses collide with nothing. Throws
    /// lancet::Error for a node number out of range.
    CollidableBody(std::size_t nodes, std::span<const mesh::Tetrahedron> tetrahedra,
                   std::span<const mesh::Triangle> surface, BroadPhaseKind kind = BroadPhaseKind::aabb_tree);

    /// Takes up where the nodes are, one place each. What is not finite touches nothing. Allocates in the first call,
    /// later in calls that build a tree anew at most. Throws lancet::Error for another number.
    void update(std::span<const Point> positions);

    std::span<const Point> positions() const noexcept { return positions_; }
    std::span<const mesh::Tetrahedron> tetrahedra() const noexcept { return tetrahedra_; }
    std::span<const mesh::Triangle> surface() const noexcept { return surface_; }
    /// The edges of the tetrahedra, each once, smaller number first, ascending.
    std::span<const std::array<std::int32_t, 2>> edges() const noexcept { return edges_; }
    /// The nodes at the other ends of a node's edges, ascending.
    std::span<const std::int32_t> neighbours(std::int32_t node) const noexcept {
        const auto begin = static_cast<std::size_t>(first_neighbour_[node]);
        return std::span(neighbours_).subspan(begin, static_cast<std::size_t>(first_neighbour_[node + 1]) - begin);
    }
    /// Whether the face opposite to a corner of a tetrahedron is a triangle of the surface.
    bool is_on_surface(std::int32_t tetrahedron, std::size_t corner) const noexcept {
        return (surface_faces_[tetrahedron] >> corner & 1U) != 0;
    }
    /// A box without size for each node; not valid for those that no tetrahedron uses.
    std::span<const Box> node_boxes() const noexcept { return node_boxes_; }

    BroadPhase& tetrahedron_boxes() const noexcept { return *tetrahedron_boxes_; }
    const BroadPhase& surface_boxes() const noexcept { return *surface_boxes_; }
    std::size_t bytes() const noexcept;

  private:
    std::vector<mesh::Tetrahedron> tetrahedra_;
    std::vector<mesh::Triangle> surface_;
    std::vector<std::array<std::int32_t, 2>> edges_;
    std::vector<std::uint8_t> surface_faces_;  ///< [tetrahedron] bits
    std::vector<std::int32_t> first_neighbour_, neighbours_;
    std::vector<Point> positions_;
    std::vector<Box> node_boxes_, boxes_;
    bool is_built_ = false;
    std::unique_ptr<BroadPhase> tetrahedron_boxes_, surface_boxes_;
};

}  // namespace lancet::runtime
