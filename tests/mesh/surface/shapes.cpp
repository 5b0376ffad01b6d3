#include "tests/mesh/surface/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace lancet::mesh::test {

TriangleMesh sphere(const Point& centre, double radius, int levels) {
    TriangleMesh unit{.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
    for (const std::int32_t x : {0, 1}) {
        for (const std::int32_t y : {2, 3}) {
            for (const std::int32_t z : {4, 5}) {
                const bool is_even = (x + y + z) % 2 == 0;
                unit.triangles.push_back(is_even ? Triangle{x, y, z} : Triangle{x, z, y});
            }
        }
    }
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
        const auto middle = [&](std::int32_t a, std::int32_t b) {
            const auto [found, is_new] =
                middles.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(unit.vertices.size()));
            if (is_new) {
                const Point p = unit.vertices[static_cast<std::size_t>(a)],
                            q = unit.vertices[static_cast<std::size_t>(b)];
                Point m{p[0] + q[0], p[1] + q[1], p[2] + q[2]};
                const double length = std::hypot(m[0], m[1], m[2]);
                for (double& x : m) x /= length;
                unit.vertices.push_back(m);
            }
            return found->second;
        };
        std::vector<Triangle> finer;
        for (const auto& [a, b, c] : unit.triangles) {
            const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(),
                         {Triangle{a, ab, ca}, Triangle{b, bc, ab}, Triangle{c, ca, bc}, Triangle{ab, bc, ca}});
        }
        unit.triangles = std::move(finer);
    }
    for (Point& p : unit.vertices) {
        for (std::size_t axis = 0; axis < 3; ++axis) p[axis] = centre[axis] + radius * p[axis];
    }
    return unit;
}

TriangleMesh cuboid(const Point& origin, const Point& size) {
    TriangleMesh box;
    for (int corner = 0; corner < 8; ++corner) {
        Point p = origin;
        for (std::size_t axis = 0; axis < 3; ++axis) p[axis] += ((corner >> axis) & 1) * size[axis];
        box.vertices.push_back(p);
    }
    box.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                     {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return box;
}

TriangleMesh torus(const Point& centre, double radius, double tube, int around, int across) {
    TriangleMesh ring;
    const auto vertex = [&](int i, int j) { return (i % around) * across + j % across; };
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < across; ++j) {
            const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
            const double r = radius + tube * std::cos(v);
            ring.vertices.push_back(
                {centre[0] + r * std::cos(u), centre[1] + r * std::sin(u), centre[2] + tube * std::sin(v)});
            const std::int32_t a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
            ring.triangles.push_back({a, b, c});
            ring.triangles.push_back({a, c, d});
        }
    }
    return ring;
}

}  // namespace lancet::mesh::test
