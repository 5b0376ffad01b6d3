#include "lancet/mesh/generate/around.hpp"

#include <numbers>
#include <string>

#include "tests/mesh/surface/shapes.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/boundary.hpp"
#include "lancet/mesh/components.hpp"
#include "lancet/mesh/embed/embedding.hpp"

namespace lancet::mesh::test {
namespace {

using testing::HasSubstr;

TEST(Around, HoldsTheSurfaceAndItsInside) {
    const TriangleMesh shapes[] = {sphere({5, -3, 2}, 0.5, 3), torus({0, 0, 0}, 1, 0.3, 40, 20),
                                   cuboid({1, 1, 1}, {0.3, 0.7, 1.1})};
    for (const TriangleMesh& shape : shapes) {
        const double volume = signed_volume(shape.vertices, shape.triangles);
        for (const Split split : {Split::five, Split::six}) {
            double last = 1e9;
            for (const double size : {0.25, 0.1, 0.05}) {
                const TetMesh mesh = around(shape, {.cell_size = size, .split = split});
                EXPECT_EQ(components(mesh).count, 1);
                EXPECT_EQ(boundary(mesh).overused_faces, 0);
                const Embedding embedding = embed(mesh, shape.vertices);
                for (const double distance : embedding.distances) EXPECT_EQ(distance, 0);
                // It covers the inside, and tends to it from above: what is too much is of the order of surface * size.
                const double excess = mesh.volume() - volume;
                EXPECT_GT(excess, 0);
                EXPECT_LT(excess, 1.5 * size * area(shape.vertices, shape.triangles));
                EXPECT_LT(excess, last);
                last = excess;
            }
        }
    }
}

TEST(Around, ATorusKeepsItsHole) {
    const TetMesh mesh = around(torus({0, 0, 0}, 1, 0.3, 40, 20), {.cell_size = 0.1});
    const Boundary surface = boundary(mesh);
    // V - E + F = 0 for the surface of a body with one hole; each triangle has three halves of edges.
    std::vector<std::uint8_t> is_on(mesh.nodes().size(), 0);
    std::int64_t euler = 0;
    for (const Triangle& t : surface.triangles) {
        for (const std::int32_t node : t) {
            euler += is_on[static_cast<std::size_t>(node)] == 0 ? 1 : 0;
            is_on[static_cast<std::size_t>(node)] = 1;
        }
    }
    const auto triangles = static_cast<std::int64_t>(surface.triangles.size());
    EXPECT_EQ(euler - 3 * triangles / 2 + triangles, 0);
    EXPECT_GT(embed(mesh, std::vector<Point>{{0, 0, 0}}).distances[0], 0.5);
}

TEST(Around, ATriangleThinnerThanACellIsMeshedToo) {
    const TriangleMesh plate = cuboid({0, 0, 0}, {1, 1, 1e-6});
    const TetMesh mesh = around(plate, {.cell_size = 0.2});
    EXPECT_EQ(components(mesh).count, 1);
    for (const double distance : embed(mesh, plate.vertices).distances) EXPECT_EQ(distance, 0);
}

TEST(Around, BadInputIsRefused) {
    const TriangleMesh ball = sphere({0, 0, 0}, 1, 2);
    const auto message = [](const TriangleMesh& surface, const AroundOptions& options) -> std::string {
        try {
            around(surface, options);
        } catch (const Error& error) {
            return error.what();
        }
        return "nothing was thrown";
    };
    EXPECT_THAT(message(ball, {}), HasSubstr("expected a positive finite length"));
    EXPECT_THAT(message(ball, {.cell_size = -1}), HasSubstr("cell size -1"));
    EXPECT_THAT(message(ball, {.cell_size = 1e-9}), HasSubstr("expected at most 20000000"));
    EXPECT_THAT(message(ball, {.cell_size = 0.5, .most_cells = 100}), HasSubstr("would be 125"));
    TriangleMesh open = ball;
    open.triangles.pop_back();
    EXPECT_THAT(message(open, {.cell_size = 0.5}), HasSubstr("expected a closed surface"));
    EXPECT_THAT(message({}, {.cell_size = 0.5}), HasSubstr("expected a closed surface"));
}

}  // namespace
}  // namespace lancet::mesh::test
