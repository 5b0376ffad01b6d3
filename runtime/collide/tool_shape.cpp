#include "lancet/runtime/collide/tool_shape.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {
namespace {

using Quaternion = std::array<double, 4>;

double dot(const Quaternion& a, const Quaternion& b) noexcept {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

/// The largest distance of the axis from the origin of the tool.
double reach(const ToolShape& shape) noexcept {
    struct Visitor {
        double operator()(const SphereTool& sphere) const { return length(sphere.centre); }
        double operator()(const CapsuleTool& capsule) const {
            return std::max(length(capsule.start), length(capsule.end));
        }
        double operator()(const ChainTool& chain) const {
            double largest = 0;
            for (const Point& point : chain.points) largest = std::max(largest, length(point));
            return largest;
        }
    };
    return std::visit(Visitor{}, shape);
}

/// The angle of the rotation from one orientation to another, along the shorter arc.
double angle_between(const Quaternion& a, const Quaternion& b) noexcept {
    const double cosine = std::abs(dot(a, b));
    Quaternion across;
    const double sign = dot(a, b) < 0 ? -1 : 1;
    for (std::size_t i = 0; i < 4; ++i) across[i] = b[i] * sign - a[i] * cosine;
    return 2 * std::atan2(std::sqrt(dot(across, across)), cosine);
}

/// The distance that `closest(segment)` finds, smallest over the axis.
template <class Closest>
ToolDistance smallest(std::span<const Segment> axis, double radius, const Closest& closest) noexcept {
    ToolDistance best;
    best.distance = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < axis.size(); ++i) {
        ToolDistance one = closest(axis[i]);
        one.distance -= radius;
        if (!(one.distance < best.distance)) continue;
        const Point on_axis = axis[i].at(one.parameter);
        one.normal = direction(subtract(on_axis, one.on_other));
        if (runtime::dot(one.normal, one.normal) == 0) {
            one.normal = perpendicular(subtract(axis[i].end, axis[i].start));
        }
        one.on_tool = add_scaled(on_axis, -radius, one.normal);
        one.segment = i;
        best = one;
    }
    return best;
}

}  // namespace

void validate(const ToolShape& shape) {
    struct Visitor {
        bool operator()(const SphereTool& sphere) const { return is_finite(sphere.centre); }
        bool operator()(const CapsuleTool& capsule) const { return is_finite(capsule.start) && is_finite(capsule.end); }
        bool operator()(const ChainTool& chain) const {
            if (chain.points.empty()) throw Error("tool: a chain without points; expected one or more");
            return std::ranges::all_of(chain.points, is_finite);
        }
    };
    if (!std::visit(Visitor{}, shape)) throw Error("tool: a point of its axis is not finite");
    const double size = radius(shape);
    if (!(size > 0 && std::isfinite(size))) {
        throw Error("tool: the radius is " + std::to_string(size) + " m; expected a positive length");
    }
}

void validate(const Pose& pose) {
    if (!is_finite(pose.position)) throw Error("tool: its position is not finite");
    const double size = std::sqrt(dot(pose.orientation, pose.orientation));
    if (!(std::abs(size - 1) < 1e-6)) {
        throw Error("tool: its orientation has length " + std::to_string(size) + "; expected a unit quaternion");
    }
}

double radius(const ToolShape& shape) noexcept {
    return std::visit([](const auto& tool) { return tool.radius; }, shape);
}

std::size_t segments(const ToolShape& shape) noexcept {
    const auto* chain = std::get_if<ChainTool>(&shape);
    return chain == nullptr || chain->points.size() < 2 ? 1 : chain->points.size() - 1;
}

Point place(const Pose& pose, const Point& of_tool) noexcept {
    // x + 2 w (q x x) + 2 q x (q x x), over |q|^2 so that rounding of the orientation does not change lengths.
    const Quaternion& o = pose.orientation;
    const Point q{o[1], o[2], o[3]}, across = cross(q, of_tool);
    const double factor = 2 / dot(o, o);
    return add(pose.position, add_scaled(add_scaled(of_tool, factor * o[0], across), factor, cross(q, across)));
}

Pose interpolate(const Pose& from, const Pose& to, double parameter) noexcept {
    Pose between;
    between.position = Segment{from.position, to.position}.at(parameter);
    const double sign = dot(from.orientation, to.orientation) < 0 ? -1 : 1;
    const double angle = angle_between(from.orientation, to.orientation) / 2;
    double first = 1 - parameter, second = parameter;
    // Below, the line and the arc differ by less than rounding.
    if (angle > 1e-8) {
        first = std::sin(first * angle) / std::sin(angle);
        second = std::sin(second * angle) / std::sin(angle);
    }
    for (std::size_t i = 0; i < 4; ++i) {
        between.orientation[i] = first * from.orientation[i] + sign * second * to.orientation[i];
    }
    return between;
}

void place_axis(const ToolShape& shape, const Pose& pose, std::span<Segment> axis) {
    struct Visitor {
        const Pose& pose;
        std::span<Segment> axis;
        void operator()(const SphereTool& sphere) const {
            const Point centre = place(pose, sphere.centre);
            axis[0] = {centre, centre};
        }
        void operator()(const CapsuleTool& capsule) const {
            axis[0] = {place(pose, capsule.start), place(pose, capsule.end)};
        }
        void operator()(const ChainTool& chain) const {
            Point last = place(pose, chain.points[0]);
            if (chain.points.size() == 1) axis[0] = {last, last};
            for (std::size_t i = 1; i < chain.points.size(); ++i) {
                const Point next = place(pose, chain.points[i]);
                axis[i - 1] = {last, next};
                last = next;
            }
        }
    };
    std::visit(Visitor{pose, axis}, shape);
}

ToolDistance tool_distance(std::span<const Segment> axis, double radius, const Point& point) noexcept {
    return smallest(axis, radius, [&](const Segment& segment) {
        ToolDistance one;
        one.parameter = closest_parameter(segment, point);
        one.on_other = point;
        one.distance = length(subtract(segment.at(one.parameter), point));
        return one;
    });
}

ToolDistance tool_distance(std::span<const Segment> axis, double radius, const Segment& other) noexcept {
    return smallest(axis, radius, [&](const Segment& segment) {
        const SegmentPair pair = closest_points(segment, other);
        ToolDistance one;
        one.parameter = pair.first;
        one.on_other = other.at(pair.second);
        one.distance = pair.distance;
        return one;
    });
}

ToolDistance tool_distance(std::span<const Segment> axis, double radius, const TrianglePoints& triangle) noexcept {
    return smallest(axis, radius, [&](const Segment& segment) {
        const SegmentTriangle found = closest_points(segment, triangle);
        ToolDistance one;
        one.parameter = found.parameter;
        one.on_other = weighted(triangle, found.point.weights);
        one.distance = found.point.distance;
        return one;
    });
}

void ToolMotion::set(const ToolShape& shape, const Pose& from, const Pose& to) {
    validate(shape);
    validate(from);
    validate(to);
    const double tool_radius = runtime::radius(shape);
    // No point of the axis moves farther: the origin along its line, the rest around it.
    const double way =
        length(subtract(to.position, from.position)) + angle_between(from.orientation, to.orientation) * reach(shape);
    // What rounding makes of equal orientations is no motion.
    const double rounding = 16 * std::numeric_limits<double>::epsilon() * reach(shape);
    const double steps = way > rounding ? std::ceil(2 * way / tool_radius) : 0;
    if (!(steps + 1 <= most_poses)) {
        throw Error("tool: it moves by " + std::to_string(way) + " m at once, " + std::to_string(way / tool_radius) +
                    " times its radius; expected no more than " + std::to_string((most_poses - 1) / 2));
    }
    radius_ = tool_radius;
    segments_ = runtime::segments(shape);
    poses_ = static_cast<std::size_t>(steps) + 1;
    axes_.resize(poses_ * segments_);
    for (std::size_t pose = 0; pose < poses_; ++pose) {
        const double parameter = poses_ == 1 ? 1 : static_cast<double>(pose) / steps;
        place_axis(shape, interpolate(from, to, parameter), std::span(axes_).subspan(pose * segments_, segments_));
    }
}

}  // namespace lancet::runtime
