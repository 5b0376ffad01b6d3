#include "lancet/mesh/surface/corner_normals.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "tests/mesh/surface/shapes.hpp"
#include <gtest/gtest.h>

#include "lancet/mesh/surface/vertex_normals.hpp"

namespace lancet::mesh::test {
namespace {

using Corners = std::array<Point, 3>;

Corners normals_of(const Corners& corners) {
    const Triangle triangle{0, 1, 2};
    Corners normals;
    normals.fill({7, 7, 7});
    corner_normals(std::span(&triangle, 1), corners, normals);
    return normals;
}

/// In long double, from the two shorter edges of the triangle: the exact answer to some 1e-18 for what is asked here.
Corners reference(const Corners& corners) {
    using Vector = std::array<long double, 3>;
    const auto edge = [&](std::size_t from, std::size_t to) {
        Vector d;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            d[axis] = static_cast<long double>(corners[to][axis]) - static_cast<long double>(corners[from][axis]);
        }
        return d;
    };
    const auto dot = [](const Vector& u, const Vector& v) { return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]; };
    std::size_t apex = 0;
    long double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vector opposite = edge((k + 1) % 3, (k + 2) % 3);
        if (dot(opposite, opposite) > longest) longest = dot(opposite, opposite), apex = k;
    }
    const Vector u = edge(apex, (apex + 1) % 3), v = edge(apex, (apex + 2) % 3);
    const Vector n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const long double length = std::sqrt(dot(n, n));
    Corners normals;
    for (std::size_t k = 0; k < 3; ++k) {
        const long double angle = std::atan2(length, dot(edge(k, (k + 1) % 3), edge(k, (k + 2) % 3)));
        for (std::size_t axis = 0; axis < 3; ++axis) normals[k][axis] = static_cast<double>(angle * n[axis] / length);
    }
    return normals;
}

double size(const Point& p) {
    return std::hypot(p[0], p[1], p[2]);
}

double distance(const Point& p, const Point& q) {
    return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

/// The largest error of a corner in units of what it should be.
double relative_error(const Corners& corners) {
    const Corners found = normals_of(corners), expected = reference(corners);
    double worst = 0;
    for (std::size_t k = 0; k < 3; ++k) worst = std::max(worst, distance(found[k], expected[k]) / size(expected[k]));
    return worst;
}

TEST(CornerNormals, AreExactToAFewRoundingsForTrianglesOfAnyShape) {
    std::mt19937_64 random(17);
    std::uniform_real_distribution<double> coordinate(-1, 1);
    std::uniform_real_distribution<double> exponent(-12, 0);
    for (int k = 0; k < 20000; ++k) {
        // A third of them plain, a third with a short edge, a third that are nearly flat; each corner in turn.
        Corners corners;
        for (Point& corner : corners) corner = {coordinate(random), coordinate(random), coordinate(random)};
        const auto moved = static_cast<std::size_t>(k % 3);
        const double little = std::pow(10, exponent(random));
        const double along = k / 3 % 3 == 1 ? 0 : 0.5 + 0.4 * coordinate(random);
        if (k / 3 % 3 != 0) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double from = corners[(moved + 1) % 3][axis], to = corners[(moved + 2) % 3][axis];
                corners[moved][axis] = from + along * (to - from) + little * coordinate(random);
            }
        }
        // Of a needle, the area is known as well as its short edge; of a flat triangle, as its height.
        const double lost = along == 0 || k / 3 % 3 == 0 ? 1 : 1 / little;
        EXPECT_LT(relative_error(corners), 1e-14 * lost) << k;
    }
}

TEST(CornerNormals, TinyAnglesKeepTheirDigits) {
    for (const double height : {1e-3, 1e-9, 1e-30, 1e-100}) {
        for (std::size_t turn = 0; turn < 3; ++turn) {
            Corners corners;
            corners[turn] = {1, 0, 0};
            corners[(turn + 1) % 3] = {0, height, 0};
            corners[(turn + 2) % 3] = {0, 0, 0};
            const Corners found = normals_of(corners);
            EXPECT_NEAR(found[turn][2] / std::atan(height), 1, 1e-15) << height;
            EXPECT_NEAR(found[(turn + 2) % 3][2], std::numbers::pi / 2, 1e-15) << height;
        }
    }
}

TEST(CornerNormals, OfATriangleAddUpToPi) {
    // Ties between angles and products of edges, in every order of the corners.
    const std::vector<Corners> triangles{{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
                                         {{{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0}}},
                                         {{{0, 0, 0}, {2, 0, 0}, {1, 0.25, 0}}},
                                         {{{0, 0, 0}, {2, 0, 0}, {1, 8, 0}}},
                                         {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
    for (const Corners& triangle : triangles) {
        for (std::size_t turn = 0; turn < 3; ++turn) {
            const Corners turned{triangle[turn], triangle[(turn + 1) % 3], triangle[(turn + 2) % 3]};
            const Corners found = normals_of(turned);
            EXPECT_NEAR(size(found[0]) + size(found[1]) + size(found[2]), std::numbers::pi, 1e-15);
            EXPECT_LT(relative_error(turned), 1e-15);
        }
    }
}

TEST(CornerNormals, DoNotDependOnBlocks) {
    const TriangleMesh ball = sphere({0.1, 0.2, 0.3}, 0.7, 3);
    const std::size_t count = ball.triangles.size();
    std::vector<Point> at_once(3 * count), one_by_one(3 * count, Point{7, 7, 7});
    corner_normals(ball.triangles, ball.vertices, at_once);
    for (std::size_t begin = 0, length = 1; begin < count; begin += length, length = length % 37 + 1) {
        const std::size_t triangles = std::min(length, count - begin);
        corner_normals(std::span(ball.triangles).subspan(begin, triangles), ball.vertices,
                       std::span(one_by_one).subspan(3 * begin, 3 * triangles));
    }
    EXPECT_EQ(one_by_one, at_once);

    const VertexCorners corners(ball.vertices.size(), ball.triangles);
    std::vector<Point> added(ball.vertices.size()), direct(ball.vertices.size());
    const std::size_t half = added.size() / 2;
    add_corner_normals(corners, at_once, half, added.size(), added);
    add_corner_normals(corners, at_once, 0, half, added);
    vertex_normals(corners, ball.vertices, 0, 100, direct);
    vertex_normals(corners, ball.vertices, 100, direct.size(), direct);
    EXPECT_EQ(added, direct);
}

TEST(CornerNormals, AreZeroWhereATriangleHasNone) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    const Corners none{};
    const Point a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0};
    EXPECT_EQ(normals_of({{a, a, a}}), none);
    EXPECT_EQ(normals_of({{a, b, a}}), none);
    EXPECT_EQ(normals_of({{a, b, {3, 0, 0}}}), none);
    for (const double bad : {nan, infinity, -infinity}) {
        EXPECT_EQ(normals_of({{a, b, {0, bad, 0}}}), none);
        EXPECT_EQ(normals_of({{a, {bad, 0, 0}, c}}), none);
        EXPECT_EQ(normals_of({{{0, 0, bad}, b, c}}), none);
    }
}

TEST(CornerNormals, DoNotDependOnTheScale) {
    const Corners expected = normals_of({{{0, 0, 0}, {2, 0, 0}, {0, 1, 1}}});
    for (const double scale : {1e-300, 1e-150, 1e-60, 1e60, 1e150, 1e300}) {
        const Corners found = normals_of({{{0, 0, 0}, {2 * scale, 0, 0}, {0, scale, scale}}});
        for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(distance(found[k], expected[k]), 1e-15) << scale;
    }
}

TEST(VertexNormals, GoThroughVerticesWithManyTrianglesOrNone) {
    // A fan of 200 triangles around the first vertex, and unused vertices before, between and behind.
    constexpr int around = 200;
    TriangleMesh fan{.vertices = {{5, 5, 5}, {0, 0, 0}, {5, 5, 5}}};
    for (int k = 0; k < around; ++k) {
        const double angle = 2 * std::numbers::pi * k / around;
        fan.vertices.push_back({std::cos(angle), std::sin(angle), 0});
        fan.triangles.push_back({1, 3 + k, 3 + (k + 1) % around});
    }
    fan.vertices.push_back({5, 5, 5});
    const VertexCorners corners(fan.vertices.size(), fan.triangles);
    std::vector<Point> normals(fan.vertices.size(), Point{7, 7, 7});
    vertex_normals(corners, fan.vertices, 0, normals.size(), normals);
    for (std::size_t v = 0; v < normals.size(); ++v) {
        const bool is_used = v != 0 && v != 2 && v + 1 != normals.size();
        EXPECT_LT(distance(normals[v], {0, 0, is_used ? 1.0 : 0.0}), 1e-15) << v;
    }
}

}  // namespace
}  // namespace lancet::mesh::test
