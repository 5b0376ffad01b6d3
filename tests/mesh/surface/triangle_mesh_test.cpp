#include "lancet/mesh/surface/triangle_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/mesh/surface/shapes.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/surface/vertex_normals.hpp"

namespace lancet::mesh::test {
namespace {

SurfaceTopology topology(const TriangleMesh& surface) {
    return surface_topology(surface.vertices.size(), surface.triangles);
}

std::vector<Point> normals(const TriangleMesh& surface) {
    const VertexCorners corners(surface.vertices.size(), surface.triangles);
    std::vector<Point> result(surface.vertices.size(), Point{7, 7, 7});
    // In two blocks, the last first.
    const std::size_t half = result.size() / 2;
    vertex_normals(corners, surface.vertices, half, result.size(), result);
    vertex_normals(corners, surface.vertices, 0, half, result);
    return result;
}

TEST(TriangleMesh, ClosedSurfacesAreKnown) {
    for (const TriangleMesh& surface :
         {sphere({1, 2, 3}, 0.5, 3), cuboid({0, 0, 0}, {1, 2, 3}), torus({0, 0, 0}, 1, 0.3, 24, 12)}) {
        const SurfaceTopology found = topology(surface);
        EXPECT_TRUE(found.is_closed());
        EXPECT_TRUE(found.is_boundary());
        EXPECT_TRUE(found.is_orientable);
        EXPECT_GT(signed_volume(surface.vertices, surface.triangles), 0);
    }
}

TEST(TriangleMesh, VolumeAndAreaAreExactForABox) {
    const TriangleMesh box = cuboid({100, 0, 0}, {1, 2, 3});
    // Coordinates are small integers: only the division by six is rounded.
    EXPECT_NEAR(signed_volume(box.vertices, box.triangles), 6, 1e-14);
    EXPECT_NEAR(area(box.vertices, box.triangles), 22, 1e-14);
}

TEST(TriangleMesh, AnOpenSurfaceHasBorders) {
    TriangleMesh box = cuboid({0, 0, 0}, {1, 1, 1});
    box.triangles.pop_back();
    const SurfaceTopology found = topology(box);
    EXPECT_EQ(found.border_edges, 3);
    EXPECT_EQ(found.unmatched_edges, 3);
    EXPECT_FALSE(found.is_closed());
    EXPECT_FALSE(found.is_boundary());
    EXPECT_TRUE(found.is_orientable);
}

TEST(TriangleMesh, ATurnedTriangleIsFound) {
    TriangleMesh box = cuboid({0, 0, 0}, {1, 1, 1});
    std::swap(box.triangles[5][0], box.triangles[5][1]);
    const SurfaceTopology found = topology(box);
    EXPECT_TRUE(found.is_closed());
    EXPECT_TRUE(found.is_orientable);
    EXPECT_EQ(found.unmatched_edges, 6);  // three edges, twice in the same direction each
}

TEST(TriangleMesh, AMoebiusStripIsNotOrientable) {
    // Five triangles around, each sharing two vertices with the next; the last turned over onto the first.
    const std::vector<Triangle> strip{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}, {3, 0, 4}, {4, 0, 1}};
    EXPECT_FALSE(surface_topology(5, strip).is_orientable);
}

TEST(TriangleMesh, SheetsThatShareAnEdgeMayStillBeABoundary) {
    // Two tetrahedra with an edge in common.
    std::vector<Triangle> two;
    for (const Tetrahedron& t : {Tetrahedron{0, 1, 2, 3}, Tetrahedron{0, 1, 4, 5}}) {
        for (const Triangle& face : opposite_faces) two.push_back({t[face[0]], t[face[1]], t[face[2]]});
    }
    const SurfaceTopology found = surface_topology(6, two);
    EXPECT_EQ(found.overused_edges, 1);
    EXPECT_FALSE(found.is_closed());
    EXPECT_TRUE(found.is_boundary());
}

TEST(TriangleMesh, BadNumbersAreRefused) {
    const std::vector<Triangle> triangles{{0, 1, 3}};
    EXPECT_THROW(surface_topology(3, triangles), Error);
    EXPECT_THROW(VertexCorners(3, triangles), Error);
    EXPECT_THROW(VertexCorners(4, std::vector<Triangle>{{0, -1, 3}}), Error);
    const std::vector<Point> vertices{{0, 0, 0}, {1, 0, std::numeric_limits<double>::quiet_NaN()}};
    EXPECT_THROW(require_valid("surface", vertices, {}), Error);
    EXPECT_TRUE(surface_topology(0, {}).is_closed());
    EXPECT_EQ(signed_volume(std::span<const Point>{}, {}), 0);
}

TEST(VertexNormals, TendToThoseOfASphere) {
    std::vector<double> errors;
    for (const int levels : {3, 4, 5}) {
        const TriangleMesh ball = sphere({0, 0, 0}, 2, levels);
        const std::vector<Point> found = normals(ball);
        double worst = 0;
        for (std::size_t v = 0; v < found.size(); ++v) {
            const auto& [x, y, z] = found[v];
            EXPECT_NEAR(x * x + y * y + z * z, 1, 1e-14);
            const auto& [p, q, r] = ball.vertices[v];
            worst = std::max(worst, std::hypot(y * r - z * q, z * p - x * r, x * q - y * p) / 2);
        }
        errors.push_back(worst);
    }
    // Where the triangles around a vertex are unlike, the error is of first order in the length of edges.
    EXPECT_LT(errors[2], std::numbers::pi / 64 / 8);  // radians: an eighth of the angle that an edge spans
    for (std::size_t k = 1; k < errors.size(); ++k) EXPECT_NEAR(std::log2(errors[k - 1] / errors[k]), 1, 0.01);
}

TEST(VertexNormals, OfACubePointAlongItsDiagonals) {
    const TriangleMesh box = cuboid({-1, -1, -1}, {2, 2, 2});
    const std::vector<Point> found = normals(box);
    // Each corner has one or two triangles of a side, but a right angle of each.
    for (std::size_t v = 0; v < found.size(); ++v) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(found[v][axis], box.vertices[v][axis] / std::sqrt(3.0), 1e-15);
        }
    }
}

TEST(VertexNormals, DoNotChangeWhereATriangleIsDivided) {
    TriangleMesh ball = sphere({0, 0, 0}, 1, 1);
    const std::vector<Point> before = normals(ball);
    const auto [a, b, c] = ball.triangles.back();
    ball.triangles.pop_back();
    const auto middle = static_cast<std::int32_t>(ball.vertices.size());
    Point centre{};
    for (const std::int32_t v : {a, b, c}) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            centre[axis] += ball.vertices[static_cast<std::size_t>(v)][axis] / 3;
    }
    ball.vertices.push_back(centre);
    ball.triangles.insert(ball.triangles.end(),
                          {Triangle{a, b, middle}, Triangle{b, c, middle}, Triangle{c, a, middle}});
    const std::vector<Point> after = normals(ball);
    for (std::size_t v = 0; v < before.size(); ++v) {
        for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(after[v][axis], before[v][axis], 1e-15);
    }
}

TEST(VertexNormals, AreDefinedForDegenerateTriangles) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    const TriangleMesh surface{
        .vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {5, 5, 5}, {nan, 0, 0}, {0, 0, 0}},
        .triangles = {{0, 1, 2}, {0, 1, 3}, {0, 5, 2}, {0, 6, 2}, {3, 3, 3}}};
    const std::vector<Point> found = normals(surface);
    EXPECT_EQ(found[0], (Point{0, 0, 1}));  // the good triangle alone
    EXPECT_EQ(found[3], (Point{0, 0, 0}));  // flat triangles only
    EXPECT_EQ(found[4], (Point{0, 0, 0}));  // no triangle
    EXPECT_EQ(found[5], (Point{0, 0, 0}));
}

TEST(VertexNormals, DoNotDependOnTheScale) {
    for (const double scale : {1e-150, 1e-6, 1e150}) {
        const std::vector<Point> found = normals(cuboid({0, 0, 0}, {scale, scale, scale}));
        EXPECT_NEAR(found[7][0], 1 / std::sqrt(3.0), 1e-15);
    }
}

}  // namespace
}  // namespace lancet::mesh::test
