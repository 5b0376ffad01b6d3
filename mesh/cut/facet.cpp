#include "lancet/mesh/cut/facet.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "lancet/kernels/error.hpp"

namespace lancet::mesh {

Plane::Plane(const Point& origin, const Normal& normal, std::span<const Point> vertices)
    : origin_(origin), normal_(normal), vertex_count_(vertices.size()) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        extended_normal_[axis] = normal[axis].extended();
        rounded_normal_[axis] = extended_normal_[axis].bounded();
        is_normal_ = is_normal_ && rounded_normal_[axis].is_precise(0x1p-50);
    }
    std::ranges::copy(vertices, vertices_.begin());
}

double Plane::function_value(const Point& place) const {
    const double value = function_(place);
    if (std::isfinite(value)) return value;
    std::ostringstream text;
    text << "cut level set: the function is " << value << " at (" << place[0] << ", " << place[1] << ", " << place[2]
         << "); expected a finite number";
    throw Error(text.str());
}

Bounded Plane::value(const Point& place) const {
    if (function_) return {function_value(place), 0};
    std::array<Bounded, 3> from_origin;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        from_origin[axis] = Bounded{place[axis], 0} - Bounded{origin_[axis], 0};
    }
    return dot(rounded_normal_, from_origin);
}

int Plane::quick_sign(const Point& place) const {
    if (function_) return Bounded{function_value(place), 0}.sign();
    if (!is_normal_) return 0;
    double sum = 0, size = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double term = rounded_normal_[axis].value * (place[axis] - origin_[axis]);
        sum += term;
        size += std::abs(term);
    }
    // Each term is right to a few roundings, unless it is below the normal numbers.
    return std::abs(sum) > 0x1p-48 * size + 0x1p-1000 ? (sum > 0 ? 1 : -1) : 0;
}

Extended Plane::extended(const Point& place) const {
    if (function_) return {function_value(place), 0, 0};
    std::array<Extended, 3> from_origin;
    for (std::size_t axis = 0; axis < 3; ++axis) from_origin[axis] = Extended::difference(place[axis], origin_[axis]);
    return dot(extended_normal_, from_origin);
}

Exact Plane::exact(const Point& place) const {
    if (function_) return Exact(function_value(place));
    std::array<Exact, 3> from_origin;
    for (std::size_t axis = 0; axis < 3; ++axis) from_origin[axis] = Exact(place[axis]) - Exact(origin_[axis]);
    return dot(normal_, from_origin);
}

Facet::Box united(const Facet::Box& a, const Facet::Box& b) {
    Facet::Box both = a;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        both[0][axis] = std::min(a[0][axis], b[0][axis]);
        both[1][axis] = std::max(a[1][axis], b[1][axis]);
    }
    return both;
}

bool are_apart(const Facet::Box& a, const Facet::Box& b) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (a[0][axis] > b[1][axis] || b[0][axis] > a[1][axis]) return true;
    }
    return false;
}

namespace {

Facet::Box box_around(const std::array<Point, 4>& corners) {
    Facet::Box box{corners[0], corners[0]};
    for (const Point& corner : corners) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box[0][axis] = std::min(box[0][axis], corner[axis]);
            box[1][axis] = std::max(box[1][axis], corner[axis]);
        }
    }
    return box;
}

bool may_touch(const Facet& facet, const std::array<Point, 4>& corners, const Facet::Box& box) {
    if (are_apart(facet.bounds, box)) return false;
    const auto are_all = [&](const Plane& plane, int sign) {
        return std::ranges::all_of(corners, [&](const Point& corner) { return plane.quick_sign(corner) == sign; });
    };
    const int first = facet.plane.quick_sign(corners[0]);
    if (first != 0 && are_all(facet.plane, first)) return false;
    return std::ranges::none_of(facet.borders, [&](const Facet::Border& border) { return are_all(border.plane, -1); });
}

}  // namespace

bool may_touch(const Facet& facet, const std::array<Point, 4>& corners) {
    return may_touch(facet, corners, box_around(corners));
}

std::vector<const Facet*> facets_near(std::span<const Facet> facets, const std::array<Point, 4>& corners) {
    const Facet::Box box = box_around(corners);
    std::vector<const Facet*> near;
    for (const Facet& facet : facets) {
        if (may_touch(facet, corners, box)) near.push_back(&facet);
    }
    return near;
}

}  // namespace lancet::mesh
