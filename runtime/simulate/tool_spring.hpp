#pragma once

#include <cstdint>
#include <vector>

#include "lancet/runtime/collide/response.hpp"
#include "lancet/runtime/simulate/surface.hpp"

namespace lancet::runtime {

/// A spring between a point of a tool and a point of a body's material. One that grabs pulls the points together; a
/// contact pushes them apart along its normal, where the tool's point is behind the body's.
struct ToolSpring {
    int body = 0;
    AttachedPoint on_body{};
    Point on_tool{};       ///< in the tool's frame
    Point normal{};        ///< out of the body, of unit length; zero: the spring grabs
    double share = 1;      ///< in (0, 1], of the stiffness that the body would bear
    double stiffness = 0;  ///< N / m; 0: not known yet

    bool is_contact() const noexcept { return normal != Point{}; }
};

/// The force of a spring on its tool, its points being at these places.
Point force_on_tool(const ToolSpring& spring, const Point& on_tool, const Point& on_body) noexcept;

/// What pushes and pulls a tool, for as long as the body has not moved much: the springs with the body's points where
/// they were (the intermediate representation of Adachi, Kumano and Ogino 1995). It is what a force-feedback device
/// asks at its own rate, between the steps of the simulation.
struct ForceModel {
    struct Anchor {
        ToolSpring spring;
        Point place{};  ///< where the body's point was
    };
    std::int64_t step = 0;   ///< world steps that had been taken
    double time = 0;         ///< s
    double input_stamp = 0;  ///< of the latest sample that it knows
    std::vector<Anchor> anchors;

    /// The force on the tool at a pose, and its moment about the tool's position. Allocates nothing.
    Wrench at(const Pose& pose) const noexcept;
};

}  // namespace lancet::runtime
