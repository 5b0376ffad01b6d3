#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::runtime {

using mesh::Point;

/// An axis-aligned box, faces included: lower <= x <= upper on each axis, in metres. A box is valid if it is finite,
/// its coordinates are below largest_coordinate in size, and no side is negative; any other box is empty.
struct Box {
    Point lower;
    Point upper;

    friend bool operator==(const Box&, const Box&) = default;
};

/// Beyond it, areas and squared distances might overflow.
inline constexpr double largest_coordinate = 1e150;

/// The empty box in the form that min, max and comparisons need: it touches nothing and adds nothing to a union.
inline constexpr Box empty_box{{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
                                std::numeric_limits<double>::infinity()},
                               {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
                                -std::numeric_limits<double>::infinity()}};

/// Whether a box is valid: not a number, inverted or infinite ones are not.
inline bool is_valid(const Box& box) noexcept {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(box.lower[axis] >= -largest_coordinate && box.lower[axis] <= box.upper[axis] &&
              box.upper[axis] <= largest_coordinate)) {
            return false;
        }
    }
    return true;
}

/// Coordinates that are smaller count as zero: so differences are never denormal, and do not depend on whether denormal
/// numbers are flushed.
inline constexpr double smallest_coordinate = 1e-290;

/// The box itself where it is valid, else empty_box.
inline Box valid_or_empty(Box box) noexcept {
    if (!is_valid(box)) return empty_box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (std::abs(box.lower[axis]) < smallest_coordinate) box.lower[axis] = 0;
        if (std::abs(box.upper[axis]) < smallest_coordinate) box.upper[axis] = 0;
    }
    return box;
}

/// Whether two boxes, each valid or empty_box, have a point in common.
inline bool touch(const Box& a, const Box& b) noexcept {
    return a.lower[0] <= b.upper[0] && b.lower[0] <= a.upper[0] &&  //
           a.lower[1] <= b.upper[1] && b.lower[1] <= a.upper[1] &&  //
           a.lower[2] <= b.upper[2] && b.lower[2] <= a.upper[2];
}

/// Whether `inner`, valid or empty_box, lies in `outer`.
inline bool contains(const Box& outer, const Box& inner) noexcept {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(outer.lower[axis] <= inner.lower[axis] && inner.upper[axis] <= outer.upper[axis])) return false;
    }
    return true;
}

/// The smallest box around two, each valid or empty_box.
inline Box unite(const Box& a, const Box& b) noexcept {
    Box all;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        all.lower[axis] = std::min(a.lower[axis], b.lower[axis]);
        all.upper[axis] = std::max(a.upper[axis], b.upper[axis]);
    }
    return all;
}

/// The smallest box around points, wider by `margin` on each side. Not valid where a point is not finite.
inline Box box_around(std::span<const Point> points, double margin = 0) noexcept {
    Box box = empty_box;
    Point not_finite{};  // zero, or not a number: std::min would pass over that
    for (const Point& point : points) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            not_finite[axis] += point[axis] - point[axis];
            box.lower[axis] = std::min(box.lower[axis], point[axis]);
            box.upper[axis] = std::max(box.upper[axis], point[axis]);
        }
    }
    if (!(not_finite == Point{})) return empty_box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box.lower[axis] -= margin;
        box.upper[axis] += margin;
    }
    return box;
}

/// Half of the surface of a box; 0 for empty_box.
inline double half_area(const Box& box) noexcept {
    const double x = box.upper[0] - box.lower[0], y = box.upper[1] - box.lower[1], z = box.upper[2] - box.lower[2];
    return x < 0 ? 0 : x * y + y * z + z * x;
}

/// The middle of a box; the origin for empty_box.
inline Point middle(const Box& box) noexcept {
    if (!(box.lower[0] <= box.upper[0])) return {};
    return {(box.lower[0] + box.upper[0]) / 2, (box.lower[1] + box.upper[1]) / 2, (box.lower[2] + box.upper[2]) / 2};
}

/// The longest side of a box; 0 for empty_box.
inline double longest_side(const Box& box) noexcept {
    return std::max({box.upper[0] - box.lower[0], box.upper[1] - box.lower[1], box.upper[2] - box.lower[2], 0.0});
}

/// The boxes around primitives (mesh::Triangle, mesh::Tetrahedron), each wider by `margin` on all sides, written to
/// `boxes`, which has one place for each.
template <class Primitive>
void boxes_around(std::span<const Point> positions, std::span<const Primitive> primitives, double margin,
                  std::span<Box> boxes) {
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        std::array<Point, std::tuple_size_v<Primitive>> corners;
        for (std::size_t corner = 0; corner < corners.size(); ++corner) {
            corners[corner] = positions[static_cast<std::size_t>(primitives[i][corner])];
        }
        boxes[i] = box_around(corners, margin);
    }
}

}  // namespace lancet::runtime
