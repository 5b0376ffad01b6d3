#include "lancet/runtime/simulate/tool_spring.hpp"

#include <algorithm>

namespace lancet::runtime {

Point force_on_tool(const ToolSpring& spring, const Point& on_tool, const Point& on_body) noexcept {
    Point stretch{};
    for (std::size_t axis = 0; axis < 3; ++axis) stretch[axis] = on_body[axis] - on_tool[axis];
    if (!spring.is_contact()) {
        for (double& value : stretch) value *= spring.stiffness;
        return stretch;
    }
    double depth = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) depth += stretch[axis] * spring.normal[axis];
    Point force = spring.normal;
    for (double& value : force) value *= spring.stiffness * std::max(0.0, depth);
    return force;
}

Wrench ForceModel::at(const Pose& pose) const noexcept {
    Wrench wrench;
    for (const Anchor& anchor : anchors) {
        const Point on_tool = place(pose, anchor.spring.on_tool);
        const Point force = force_on_tool(anchor.spring, on_tool, anchor.place);
        Point arm{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            wrench.force[axis] += force[axis];
            arm[axis] = on_tool[axis] - pose.position[axis];
        }
        wrench.moment[0] += arm[1] * force[2] - arm[2] * force[1];
        wrench.moment[1] += arm[2] * force[0] - arm[0] * force[2];
        wrench.moment[2] += arm[0] * force[1] - arm[1] * force[0];
    }
    return wrench;
}

}  // namespace lancet::runtime
