#include "lancet/runtime/collide/closest.hpp"

#include <algorithm>

namespace lancet::runtime {
namespace {

constexpr std::array<std::array<std::size_t, 2>, 3> edges{{{0, 1}, {1, 2}, {2, 0}}};

double distance_between(const Point& a, const Point& b) noexcept {
    return length(subtract(a, b));
}

/// The weights of the foot of the perpendicular from a place to the plane of a triangle; not finite where it is flat.
/// The weight of the corner off the longest side comes first, and then that along the side, which makes up for its
/// error: so what a sliver makes uncertain moves the foot across it alone, by less than its height.
std::array<double, 3> foot(const TrianglePoints& corners, const Point& place) noexcept {
    std::size_t longest = 0;
    std::array<double, 3> sides{};
    for (std::size_t edge = 0; edge < 3; ++edge) {
        sides[edge] = distance_between(corners[edges[edge][0]], corners[edges[edge][1]]);
        if (sides[edge] > sides[longest]) longest = edge;
    }
    const auto [from, to] = edges[longest];
    const std::size_t off = 3 - from - to;
    const Point along = scale(subtract(corners[to], corners[from]), 1 / sides[longest]);
    const Point to_off = subtract(corners[off], corners[from]), to_place = subtract(place, corners[from]);
    const double off_along = dot(to_off, along);
    const Point across = add_scaled(to_off, -off_along, along);
    std::array<double, 3> weights{};
    weights[off] = dot(to_place, across) / dot(across, across);
    weights[to] = (dot(to_place, along) - weights[off] * off_along) / sides[longest];
    weights[from] = 1 - weights[off] - weights[to];
    return weights;
}

bool is_inside(const std::array<double, 3>& weights) noexcept {
    return weights[0] > 0 && weights[1] > 0 && weights[2] > 0;
}

}  // namespace

Point unit_normal(const TrianglePoints& corners) noexcept {
    const Point u = subtract(corners[1], corners[0]), v = subtract(corners[2], corners[0]);
    const Point normal = cross(u, v);
    const double side = std::max({length(u), length(v), distance_between(corners[1], corners[2])});
    return length(normal) > 1e-13 * side * side ? direction(normal) : Point{};
}

double closest_parameter(const Segment& segment, const Point& place) noexcept {
    const Point along = subtract(segment.end, segment.start);
    const double squared = dot(along, along);
    if (!(squared > 0)) return 0;
    return std::clamp(dot(subtract(place, segment.start), along) / squared, 0.0, 1.0);
}

SegmentPair closest_points(const Segment& first, const Segment& second) noexcept {
    SegmentPair best;
    best.distance = std::numeric_limits<double>::infinity();
    const auto consider = [&](double s, double t) {
        const double distance = distance_between(first.at(s), second.at(t));
        if (distance < best.distance) best = {s, t, distance};
    };
    // Between their insides, unless they are parallel; then, and where that point is outside, an end is closest.
    const Point u = subtract(first.end, first.start), v = subtract(second.end, second.start);
    const Point w = subtract(first.start, second.start);
    const double a = dot(u, u), b = dot(u, v), c = dot(v, v);
    const double determinant = a * c - b * b;
    if (determinant > 0) {
        const double s = std::clamp((b * dot(v, w) - c * dot(u, w)) / determinant, 0.0, 1.0);
        const double t = closest_parameter(second, first.at(s));
        consider(closest_parameter(first, second.at(t)), t);
    }
    for (const double s : {0.0, 1.0}) consider(s, closest_parameter(second, first.at(s)));
    for (const double t : {0.0, 1.0}) consider(closest_parameter(first, second.at(t)), t);
    return best;
}

TrianglePoint closest_point(const TrianglePoints& corners, const Point& place) noexcept {
    TrianglePoint best;
    best.distance = std::numeric_limits<double>::infinity();
    for (const auto& edge : edges) {
        const Segment segment{corners[edge[0]], corners[edge[1]]};
        const double parameter = closest_parameter(segment, place);
        const double distance = distance_between(segment.at(parameter), place);
        if (!(distance < best.distance)) continue;
        best.weights = {};
        best.weights[edge[0]] = 1 - parameter;
        best.weights[edge[1]] = parameter;
        best.distance = distance;
    }
    const std::array<double, 3> inside = foot(corners, place);
    if (is_inside(inside)) {
        const double distance = distance_between(weighted(corners, inside), place);
        if (distance < best.distance) best = {inside, distance};
    }
    return best;
}

SegmentTriangle closest_points(const Segment& segment, const TrianglePoints& corners) noexcept {
    SegmentTriangle best;
    best.point.distance = std::numeric_limits<double>::infinity();
    const Point normal = unit_normal(corners);
    if (dot(normal, normal) > 0) {
        const double start = dot(normal, subtract(segment.start, corners[0]));
        const double end = dot(normal, subtract(segment.end, corners[0]));
        if (start * end < 0) {
            const double parameter = start / (start - end);
            const std::array<double, 3> weights = foot(corners, segment.at(parameter));
            if (is_inside(weights)) return {parameter, {weights, 0}, true};
        }
    }
    for (const double parameter : {0.0, 1.0}) {
        const TrianglePoint point = closest_point(corners, segment.at(parameter));
        if (point.distance < best.point.distance) best = {parameter, point, false};
    }
    for (const auto& edge : edges) {
        const SegmentPair pair = closest_points(segment, Segment{corners[edge[0]], corners[edge[1]]});
        // What is as close to a face is not given to its edge.
        if (!(pair.distance < best.point.distance)) continue;
        TrianglePoint point;
        point.weights[edge[0]] = 1 - pair.second;
        point.weights[edge[1]] = pair.second;
        point.distance = pair.distance;
        best = {pair.first, point, false};
    }
    return best;
}

}  // namespace lancet::runtime
