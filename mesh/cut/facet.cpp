#include "lancet/mesh/cut/facet.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "lancet/kernels/error.hpp"

namespace lancet::mesh {

Plane::Plane(const Point& origin, const Normal& normal)
    : origin_(origin),
      normal_(normal),
      rounded_normal_{normal[0].bounded(), normal[1].bounded(), normal[2].bounded()} {}

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

bool overlap(const Facet::Box& box, const std::array<Point, 4>& corners) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto [lowest, highest] =
            std::minmax({corners[0][axis], corners[1][axis], corners[2][axis], corners[3][axis]});
        if (lowest > box[1][axis] || highest < box[0][axis]) return false;
    }
    return true;
}

bool may_touch(const Facet& facet, const std::array<Point, 4>& corners) {
    if (!overlap(facet.bounds, corners)) return false;
    const auto are_all = [&](const Plane& plane, int sign) {
        return std::ranges::all_of(corners, [&](const Point& corner) {
            const Bounded value = plane.value(corner);
            return value.is_certain() && value.sign() == sign;
        });
    };
    if (are_all(facet.plane, 1) || are_all(facet.plane, -1)) return false;
    return std::ranges::none_of(facet.borders, [&](const Facet::Border& border) { return are_all(border.plane, -1); });
}

}  // namespace lancet::mesh
