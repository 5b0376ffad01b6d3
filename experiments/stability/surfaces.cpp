#include "lancet/experiments/stability/surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::stability {

namespace {

using mesh::CutSurface;
using mesh::Point;

Point minus(const Point& a, const Point& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Point plus(const Point& a, double factor, const Point& b) {
    return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}

Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// One coordinate moved to the next number.
Point beside(Point p, Random& random) {
    const double infinity = std::numeric_limits<double>::infinity();
    double& moved = p[random.below(3)];
    moved = std::nextafter(moved, random.chance(0.5) ? infinity : -infinity);
    return p;
}

using Corners = std::array<Point, 4>;

Point place_in(const Corners& corners, Random& random) {
    const auto weights = random.barycentric();
    Point place{};
    for (std::size_t k = 0; k < 4; ++k) place = plus(place, weights[k], corners[k]);
    return place;
}

/// Three points on which a surface hangs.
std::array<Point, 3> anchors(const Corners& corners, Random& random) {
    std::array<std::size_t, 4> order{0, 1, 2, 3};
    for (std::size_t k = 3; k > 0; --k) std::swap(order[k], order[random.below(k + 1)]);
    const std::size_t from_mesh = random.below(4);  // how many are nodes
    std::array<Point, 3> points{};
    for (std::size_t k = 0; k < 3; ++k) {
        points[k] = k < from_mesh ? corners[order[k]] : place_in(corners, random);
        // The middle of an edge: on it up to rounding.
        if (k >= from_mesh && random.chance(0.2)) {
            const Point &a = corners[order[k]], &b = corners[order[3]];
            points[k] = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
        }
        if (random.chance(0.15)) points[k] = beside(points[k], random);
    }
    return points;
}

/// What a straight blade sweeps that starts at two of the points and goes on past the third.
CutSurface sweep(const std::array<Point, 3>& p, Random& random) {
    std::vector<std::array<Point, 2>> places{{p[0], p[1]}};
    const Point along = minus(p[2], p[0]), edge = minus(p[1], p[0]);
    const double turn = random.uniform(-0.5, 0.5);
    const int count = random.between(1, 4);
    for (int k = 1; k <= count; ++k) {
        const double way = random.uniform(0.2, 1.5);
        std::array<Point, 2> next = places.back();
        next[0] = plus(next[0], way, along);
        next[1] = plus(plus(next[1], way, along), turn, cross(edge, along));
        places.push_back(next);
    }
    return CutSurface::swept(places);
}

CutSurface triangles(const std::array<Point, 3>& p, const Corners& corners, Random& random) {
    std::vector<Point> vertices(p.begin(), p.end());
    std::vector<mesh::Triangle> faces{{0, 1, 2}};
    // Each further triangle goes on from the last one's newest edge.
    for (int k = random.between(0, 3); k > 0; --k) {
        const auto last = static_cast<std::int32_t>(vertices.size());
        Point next = place_in(corners, random);
        if (random.chance(0.5)) next = plus(next, random.uniform(0.5, 2), minus(next, p[0]));
        vertices.push_back(next);
        faces.push_back({last - 2, last - 1, last});
    }
    return CutSurface::triangulated(vertices, faces);
}

std::optional<CutSurface> try_surface(const Corners& corners, Random& random) {
    const std::array<Point, 3> p = anchors(corners, random);
    const Point first = minus(p[1], p[0]), second = minus(p[2], p[0]), normal = cross(first, second);
    const double size = random.logarithmic(0.3, 10);
    try {
        switch (random.below(7)) {
            case 0:
                return CutSurface::plane(p[0], normal);
            case 1: {  // along an axis: through the faces of a box
                Point axis{};
                axis[random.below(3)] = random.chance(0.5) ? 1 : -1;
                return CutSurface::plane(p[0], axis);
            }
            case 2:
                return CutSurface::half_plane(p[0], normal, random.chance(0.5) ? first : second);
            case 3:
                return CutSurface::parallelogram(p[0], plus({}, size, first), plus({}, size, second));
            case 4:
                return triangles(p, corners, random);
            case 5:
                return sweep(p, random);
            default: {
                const double radius = random.uniform(0.2, 1) * std::hypot(first[0], first[1], first[2]);
                const Point centre = p[0];
                return CutSurface::level_set([centre, radius](const Point& x) {
                    return std::hypot(x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]) - radius;
                });
            }
        }
    } catch (const Error&) {
        return std::nullopt;  // no area or no direction, as where two points coincide
    }
}

}  // namespace

CutSurface random_surface(const mesh::CutMesh& cut, std::int32_t part, std::span<const Point> positions,
                          Random& random) {
    Corners corners{};
    for (std::size_t k = 0; k < 4; ++k) {
        corners[k] = positions[static_cast<std::size_t>(cut.parts()[static_cast<std::size_t>(part)][k])];
    }
    while (true) {
        if (auto surface = try_surface(corners, random)) return *surface;
    }
}

CutSurface around_node(const mesh::CutMesh& cut, std::int32_t node) {
    std::vector<mesh::Triangle> faces;
    for (const std::int32_t element : cut.star(node)) {
        mesh::Triangle face{};
        std::size_t count = 0;
        for (const std::int32_t other : cut.mesh().tetrahedra()[static_cast<std::size_t>(element)]) {
            if (other != node) face[count++] = other;
        }
        faces.push_back(face);
    }
    return CutSurface::triangulated(cut.mesh().nodes(), faces);
}

}  // namespace lancet::experiments::stability
