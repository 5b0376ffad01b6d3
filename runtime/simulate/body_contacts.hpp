#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lancet/runtime/collide/vertex_contact.hpp"
#include "lancet/runtime/simulate/simulated_body.hpp"

namespace lancet::runtime {

/// A point of one body inside of another, or of itself: both push each other apart along a normal.
struct BodyContact {
    int first = 0, second = 0;
    AttachedPoint on_first{};   ///< the vertex that is inside
    AttachedPoint on_second{};  ///< the material that is in the same place
    Point normal{};             ///< out of the second, of unit length
    double depth = 0;           ///< m, when it was found
};

/// Finds where bodies are in each other, from snapshots of where they were.
class BodyContactFinder {
  public:
    BodyContactFinder(std::span<const std::unique_ptr<SimulatedBody>> bodies, BroadPhaseKind kind);

    /// `snapshots` by body, nullptr where there is none. Contacts by pairs of bodies, in the order of the bodies;
    /// between two bodies both ways. They replace what was in `contacts`.
    void find(Scheduler& scheduler, std::span<const MotionSnapshot* const> snapshots,
              std::vector<BodyContact>& contacts);

  private:
    struct Solid {
        std::int64_t version = -1;
        std::optional<CollidableBody> body;
        std::vector<Point> positions;
        Box box{};
        bool is_up_to_date = false;  ///< the body with the positions
    };
    void add(Scheduler& scheduler, int first, int second, std::span<const MotionSnapshot* const> snapshots,
             std::vector<BodyContact>& contacts);

    BroadPhaseKind kind_;
    std::vector<bool> with_others_, with_itself_;
    std::vector<Solid> solids_;
    VertexContactFinder finder_;
    std::vector<VertexContact> found_;
};

}  // namespace lancet::runtime
