#pragma once

#include <array>
#include <span>
#include <variant>
#include <vector>

#include "lancet/runtime/collide/closest.hpp"

namespace lancet::runtime {

/// Tools are round: all points within `radius` of an axis of segments, in coordinates of the tool. Metres.
struct SphereTool {
    double radius = 0.01;
    Point centre{};
};
struct CapsuleTool {
    Point start{};
    Point end{};
    double radius = 0.01;
};
/// Segments one after the other, such as a probe that is bent.
struct ChainTool {
    std::vector<Point> points{};
    double radius = 0.01;
};
using ToolShape = std::variant<SphereTool, CapsuleTool, ChainTool>;

/// Where a tool is: x = position + R(orientation) x_tool.
struct Pose {
    Point position{};
    std::array<double, 4> orientation{1, 0, 0, 0};  ///< unit quaternion w, x, y, z

    friend bool operator==(const Pose&, const Pose&) = default;
};

/// Throws lancet::Error for a radius that is not positive, a chain without points, or what is not finite.
void validate(const ToolShape& shape);
/// Throws lancet::Error for what is not finite, or an orientation that is not of unit length (to 1e-6).
void validate(const Pose& pose);

double radius(const ToolShape& shape) noexcept;
/// The number of segments of its axis; at least 1.
std::size_t segments(const ToolShape& shape) noexcept;
/// Where a pose takes a point of the tool.
Point place(const Pose& pose, const Point& of_tool) noexcept;
/// The pose between two: the position on a line, the orientation at constant speed on the shorter arc.
Pose interpolate(const Pose& from, const Pose& to, double parameter) noexcept;
/// The axis in space, segments(shape) of them.
void place_axis(const ToolShape& shape, const Pose& pose, std::span<Segment> axis);

/// How a point, segment or triangle lies to a tool, given by its axis in space and radius.
struct ToolDistance {
    double distance = 0;  ///< to the tool's surface, negative inside: the distance to the axis less the radius
    Point on_tool{};      ///< the closest point of the surface around the closest segment
    Point on_other{};
    Point normal{};           ///< unit vector at on_other towards the axis; on the axis: at right angles to it
    std::size_t segment = 0;  ///< of the axis; the first of several that are as close
    double parameter = 0;     ///< on it
};
ToolDistance tool_distance(std::span<const Segment> axis, double radius, const Point& point) noexcept;
ToolDistance tool_distance(std::span<const Segment> axis, double radius, const Segment& segment) noexcept;
ToolDistance tool_distance(std::span<const Segment> axis, double radius, const TrianglePoints& triangle) noexcept;

/// A tool on its way from one pose to another, as its axes at so many poses between that no point of the axis moves by
/// more than half of the radius from one to the next. So what the axis passes is within a quarter of the radius of the
/// axis at one of the poses: nothing that the axis passes is missed, however fast it is.
class ToolMotion {
  public:
    /// A tool that does not move.
    void set(const ToolShape& shape, const Pose& pose) { set(shape, pose, pose); }
    /// Allocates only where the tool has more segments, or moves farther, than before. Throws lancet::Error as validate
    /// does, and for a motion of more than most_poses poses: a tool that is put elsewhere starts there.
    void set(const ToolShape& shape, const Pose& from, const Pose& to);

    static constexpr int most_poses = 1024;

    double radius() const noexcept { return radius_; }
    /// At least 1; the last is where the motion ends.
    std::size_t poses() const noexcept { return poses_; }
    std::span<const Segment> axis(std::size_t pose) const noexcept {
        return std::span(axes_).subspan(pose * segments_, segments_);
    }
    std::span<const Segment> end() const noexcept { return axis(poses_ - 1); }

  private:
    double radius_ = 0;
    std::size_t segments_ = 0, poses_ = 0;
    std::vector<Segment> axes_;
};

}  // namespace lancet::runtime
