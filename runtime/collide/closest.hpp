#pragma once

#include <array>

#include "lancet/runtime/collide/vector3.hpp"

namespace lancet::runtime {

/// A line from one end to another; both may be one point.
struct Segment {
    Point start;
    Point end;

    Point at(double parameter) const noexcept { return add_scaled(start, parameter, subtract(end, start)); }
};

using TrianglePoints = std::array<Point, 3>;

/// sum_i weights_i corners_i.
inline Point weighted(const TrianglePoints& corners, const std::array<double, 3>& weights) noexcept {
    return add_scaled(add_scaled(scale(corners[0], weights[0]), weights[1], corners[1]), weights[2], corners[2]);
}

/// The right-handed normal of unit length, or zero where the corners lie on a line to rounding: where twice the area is
/// below 1e-13 of the square of the longest side.
Point unit_normal(const TrianglePoints& corners) noexcept;

/// The parameter in [0, 1] of the point of a segment that is closest to a place.
double closest_parameter(const Segment& segment, const Point& place) noexcept;

/// Two closest points of two segments. Where there are many, as of parallel ones, one of them.
struct SegmentPair {
    double first = 0, second = 0;  ///< parameters
    double distance = 0;
};
SegmentPair closest_points(const Segment& first, const Segment& second) noexcept;

/// The point of a triangle that is closest to a place, by its weights: none negative, zero exactly where the point lies
/// on an edge or corner; the sum is 1. Also of triangles that are a line or a point.
struct TrianglePoint {
    std::array<double, 3> weights{};
    double distance = 0;

    bool is_interior() const noexcept { return weights[0] > 0 && weights[1] > 0 && weights[2] > 0; }
};
TrianglePoint closest_point(const TrianglePoints& corners, const Point& place) noexcept;

/// Two closest points of a segment and a triangle.
struct SegmentTriangle {
    double parameter = 0;  ///< on the segment
    TrianglePoint point{};
    bool pierces = false;  ///< the segment passes through the triangle: the distance is 0
};
SegmentTriangle closest_points(const Segment& segment, const TrianglePoints& corners) noexcept;

}  // namespace lancet::runtime
