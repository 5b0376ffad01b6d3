#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lancet/runtime/collide/tool_contact.hpp"
#include "lancet/runtime/simulate/surface.hpp"

namespace lancet::runtime {

/// A body's surface as the collision task sees it: where its vertices were, and what finds the triangles near a tool.
class TouchableSurface {
  public:
    TouchableSurface() : boxes_near_(make_broad_phase(BroadPhaseKind::brute_force)) {}

    /// Takes up where the vertices are. The positions must stay as long as contacts are asked for.
    void update(std::span<const Point> positions);
    /// The contacts of a tool that has moved; valid until the next call. Looks at single triangles only where
    /// vertices are not all beyond one side of the tool's box, and closely only at those whose boxes touch the one
    /// around the tool's way: there are few tools, and that costs less than keeping a tree of the triangles.
    std::span<const ToolContact> contacts(const CarriedSurface& surface, const ToolMotion& motion);

  private:
    /// Finds the triangles whose boxes may touch a box.
    void find_near(const CarriedSurface& surface, const Box& box);

    std::int64_t version_ = -1;
    std::span<const Point> positions_;
    std::vector<std::uint8_t> sides_;  ///< [vertex] those of a box beyond which it lies, a bit for each
    // Of the triangles that are near:
    std::vector<std::int32_t> numbers_;
    std::vector<mesh::Triangle> near_;
    std::vector<Box> boxes_;
    std::unique_ptr<BroadPhase> boxes_near_;
    ToolContactFinder finder_;
    std::vector<ToolContact> contacts_;
};

}  // namespace lancet::runtime
