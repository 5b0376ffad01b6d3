#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "lancet/runtime/collide/broad_phase.hpp"
#include "lancet/runtime/collide/tool_shape.hpp"

namespace lancet::runtime {

/// A tool in a triangle of a surface.
struct ToolContact {
    std::int32_t triangle = 0;
    std::array<double, 3> weights{};  ///< of the triangle's corners: where the surface is touched
    Point place{};                    ///< the same in space
    Point normal{};                   ///< unit vector out of the body
    double depth = 0;                 ///< positive: how far the tool has to move along the normal, about
    double share = 1;                 ///< in (0, 1]: the cosine of the angle between this normal and the triangle's
};

/// Finds where a tool lies in a closed surface, whose triangles are counter-clockwise as seen from outside.
///
/// Each triangle gives one contact at most, with the segment of the tool's axis that is deepest in it. Let a be the
/// point of the axis and p that of the triangle that are closest, n the triangle's normal, r the radius:
///     p inside of the triangle:  normal n, depth r - n . (a - p): more than r where the axis is behind the surface;
///     p on an edge or corner:    normal along a - p, depth r - |a - p|, if n . (a - p) > 0;
///                                normal along p - a, depth r + |a - p|, if the same is negative for all triangles
///                                there; else none: the axis is beside the triangle;
///     the axis passes through:   as the first, with the end of the segment that is behind.
/// The share, |n . (a - p)| / |a - p|, goes to zero where the triangle turns its back, so that shares times depths
/// change continuously as the tool slides over a surface from outside. Neighbours may share a tool: contacts are places
/// where penalties act, not counts. Flat triangles give none; their neighbours have their edges.
///
/// A tool that moved is tested at its end, and where it crossed a triangle from the front on the way (see ToolMotion)
/// and ends behind it, it is in contact still, with the depth it then has. So a thin tool cannot pass at once. What it
/// has crossed is not remembered: a tool whose axis is left more than r below the surface is not found by the next call
/// unless it is told where the motion started. An axis in front of one wall may lie behind another that is nearer than
/// r: bodies should be thicker than tools.
class ToolContactFinder {
  public:
    /// `surface`: over the boxes of `triangles` at `positions`. The contacts, by triangle, replace what was in
    /// `contacts`.
    void find(const BroadPhase& surface, std::span<const Point> positions, std::span<const mesh::Triangle> triangles,
              const ToolMotion& motion, std::vector<ToolContact>& contacts);

    /// The triangles whose boxes touched that of a segment of the tool in the last call.
    std::size_t candidates() const noexcept { return candidates_.size(); }

  private:
    /// A segment of the axis at a pose whose box touches that of a triangle.
    struct Near {
        std::int32_t triangle;
        std::int32_t pose;
        std::int32_t segment;

        friend auto operator<=>(const Near&, const Near&) = default;
    };
    std::vector<Near> near_;
    std::vector<std::int32_t> found_, candidates_;
};

}  // namespace lancet::runtime
