#include "lancet/mesh/surface/inside_test.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::mesh {

namespace {

std::vector<Bounds> boxes_of(const TriangleMesh& surface) {
    std::vector<Bounds> boxes;
    boxes.reserve(surface.triangles.size());
    for (const auto& [a, b, c] : surface.triangles) {
        boxes.push_back(bounds(std::array{surface.vertices[static_cast<std::size_t>(a)],
                                          surface.vertices[static_cast<std::size_t>(b)],
                                          surface.vertices[static_cast<std::size_t>(c)]}));
    }
    return boxes;
}

}  // namespace

InsideTest::InsideTest(const TriangleMesh& surface) : surface_(surface) {
    require_valid("surface", surface.vertices, surface.triangles);
    const SurfaceTopology topology = surface_topology(surface.vertices.size(), surface.triangles);
    if (surface.triangles.empty() || !topology.is_boundary()) {
        throw Error("surface: " + std::to_string(topology.border_edges) + " edges have one triangle and " +
                    std::to_string(topology.unmatched_edges) +
                    " sides of triangles no opposite one; expected a closed surface, consistently oriented");
    }
    grid_ = BoxGrid(boxes_of(surface));
}

bool InsideTest::is_odd(const Point& place, std::size_t axis) const {
    Bounds ray{place, place};
    ray[1][axis] = std::numeric_limits<double>::infinity();
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    bool is_odd = false;
    grid_.for_each_overlap(ray, [&](std::int32_t triangle) {
        const Triangle& t = surface_.triangles[static_cast<std::size_t>(triangle)];
        const auto vertex = [&](std::int32_t n) -> const Point& {
            return surface_.vertices[static_cast<std::size_t>(n)];
        };
        // Twice the area that each edge spans with the place, as seen along the ray. It is computed in the same way for
        // both triangles of an edge: the place is on one side of it for both. A place that lies on it is taken as
        // moved a little along u and, much less, along v.
        std::array<double, 3> across{};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t from = t[(k + 1) % 3], to = t[(k + 2) % 3];
            const Point &a = vertex(std::min(from, to)), &b = vertex(std::max(from, to));
            double area = (a[u] - place[u]) * (b[v] - place[v]) - (a[v] - place[v]) * (b[u] - place[u]);
            if (area == 0) {
                const double change = a[v] != b[v] ? a[v] - b[v] : b[u] - a[u];
                area = std::copysign(change == 0 ? 0 : std::numeric_limits<double>::min(), change);
            }
            across[k] = from < to ? area : -area;
        }
        if (across[0] == 0 || across[1] == 0 || across[2] == 0) return;  // seen from its edge
        const bool is_hit = (across[0] > 0) == (across[1] > 0) && (across[1] > 0) == (across[2] > 0);
        if (!is_hit) return;
        const double sum = across[0] + across[1] + across[2];
        double height = 0;
        for (std::size_t k = 0; k < 3; ++k) height += across[k] / sum * (vertex(t[k])[axis] - place[axis]);
        if (height > 0) is_odd = !is_odd;
    });
    return is_odd;
}

bool InsideTest::contains(const Point& place) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(place[axis] >= grid_.bounds()[0][axis] && place[axis] <= grid_.bounds()[1][axis])) return false;
    }
    const bool x = is_odd(place, 0), y = is_odd(place, 1), z = is_odd(place, 2);
    if (x == y && y == z) return x;
    return std::abs(winding_number(place)) > 0.5;
}

double InsideTest::winding_number(const Point& place) const {
    double angle = 0;
    for (const Triangle& t : surface_.triangles) {
        std::array<Point, 3> r{};
        std::array<double, 3> length{};
        for (std::size_t k = 0; k < 3; ++k) {
            const Point& vertex = surface_.vertices[static_cast<std::size_t>(t[k])];
            for (std::size_t axis = 0; axis < 3; ++axis) r[k][axis] = vertex[axis] - place[axis];
            length[k] = std::hypot(r[k][0], r[k][1], r[k][2]);
        }
        const auto dot = [](const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
        const double volume = 6 * signed_volume({0, 0, 0}, r[0], r[1], r[2]);
        const double divisor = length[0] * length[1] * length[2] + dot(r[0], r[1]) * length[2] +
                               dot(r[1], r[2]) * length[0] + dot(r[2], r[0]) * length[1];
        angle += 2 * std::atan2(volume, divisor);
    }
    return angle / (4 * std::numbers::pi);
}

}  // namespace lancet::mesh
