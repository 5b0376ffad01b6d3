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
    explicit TouchableSurface(BroadPhaseKind kind) : triangles_near_(make_broad_phase(kind)) {}

    /// Takes up where the body's nodes are.
    void update(Scheduler& scheduler, const CarriedSurface& surface, std::span<const Point> nodes);
    /// The contacts of a tool that has moved; valid until the next call. Looks at single triangles only where the tool
    /// comes into the box around all.
    std::span<const ToolContact> contacts(const CarriedSurface& surface, const ToolMotion& motion);

  private:
    void update_boxes(const CarriedSurface& surface);

    std::int64_t version_ = -1;
    bool boxes_are_old_ = true;
    Box box_{};  ///< around all vertices
    std::vector<Point> positions_;
    std::vector<Box> boxes_;
    std::unique_ptr<BroadPhase> triangles_near_;
    ToolContactFinder finder_;
    std::vector<ToolContact> contacts_;
};

}  // namespace lancet::runtime
