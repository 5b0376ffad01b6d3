#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lancet/mesh/tet_mesh.hpp"
#include "lancet/runtime/collide/tool_shape.hpp"

namespace lancet::experiments::collision {

using mesh::Point;

/// A body whose nodes go a prescribed way.
struct MovingBody {
    std::size_t nodes = 0;
    std::vector<mesh::Tetrahedron> tetrahedra{};
    std::vector<mesh::Triangle> surface{};
    std::function<void(double time, std::span<Point> positions)> place;  ///< time from 0 to 1
};

/// What collides: a body with itself, with a second one, or with a tool.
struct Scene {
    std::string name;
    std::string title;
    MovingBody body;                           ///< what the broad phases are built over
    std::optional<MovingBody> other{};         ///< whose vertices are looked for in the body
    std::optional<runtime::ToolShape> tool{};  ///< against the body's surface
    std::function<runtime::Pose(double time)> tool_pose{};

    /// Triangles of the surface where there is a tool, else tetrahedra.
    [[nodiscard]] std::size_t primitives() const { return tool ? body.surface.size() : body.tetrahedra.size(); }
};

/// - organ: a bent probe is drawn over the surface of a beating organ, and into it
/// - bodies: a block sinks into another, both shaking
/// - folded: a bar is folded onto itself until its halves press on each other
[[nodiscard]] std::span<const std::string_view> scene_names();

/// The scene with about so many primitives. Throws lancet::Error for another name.
[[nodiscard]] Scene make_scene(std::string_view name, int primitives);

}  // namespace lancet::experiments::collision
