#pragma once

#include <cmath>

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::runtime {

using mesh::Point;

inline Point add(const Point& a, const Point& b) noexcept {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Point subtract(const Point& a, const Point& b) noexcept {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Point scale(const Point& a, double factor) noexcept {
    return {a[0] * factor, a[1] * factor, a[2] * factor};
}
/// a + factor b.
inline Point add_scaled(const Point& a, double factor, const Point& b) noexcept {
    return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}
inline double dot(const Point& a, const Point& b) noexcept {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Point cross(const Point& a, const Point& b) noexcept {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Point& a) noexcept {
    return std::hypot(a[0], a[1], a[2]);
}
inline bool is_finite(const Point& a) noexcept {
    return std::isfinite(a[0]) && std::isfinite(a[1]) && std::isfinite(a[2]);
}

/// a / |a|, or zero where that has no direction.
inline Point direction(const Point& a) noexcept {
    const double size = length(a);
    return size > 0 && std::isfinite(size) ? scale(a, 1 / size) : Point{};
}

/// A unit vector at right angles to a; any, where a is zero. Defined by a alone.
inline Point perpendicular(const Point& a) noexcept {
    std::size_t smallest = 0;
    for (const std::size_t axis : {1U, 2U}) {
        if (std::abs(a[axis]) < std::abs(a[smallest])) smallest = axis;
    }
    Point unit{};
    unit[smallest] = 1;
    const Point normal = direction(cross(a, unit));
    return dot(normal, normal) > 0 ? normal : unit;
}

}  // namespace lancet::runtime
