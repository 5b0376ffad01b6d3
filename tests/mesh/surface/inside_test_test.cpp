#include "lancet/mesh/surface/inside_test.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "tests/mesh/surface/shapes.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::mesh::test {
namespace {

TEST(BoxGrid, FindsEveryBoxOnce) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const double size : {0.0, 0.05, 0.9}) {
        std::vector<Bounds> boxes;
        for (int k = 0; k < 400; ++k) {
            const Point low{uniform(random), k % 3 == 0 ? 0.5 : uniform(random), uniform(random)};
            boxes.push_back({low, {low[0] + size * uniform(random), low[1], low[2] + size}});
        }
        const BoxGrid grid(boxes);
        for (int k = 0; k < 200; ++k) {
            const Point low{1.4 * uniform(random) - 0.2, 0.5, uniform(random)};
            const Bounds asked{low, {low[0] + uniform(random), 0.5 + 0.3 * uniform(random), low[2] + 0.2}};
            std::multiset<std::int32_t> found, expected;
            grid.for_each_overlap(asked, [&](std::int32_t box) { found.insert(box); });
            for (std::size_t b = 0; b < boxes.size(); ++b) {
                bool is_common = true;
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    is_common = is_common && boxes[b][0][axis] <= asked[1][axis] && asked[0][axis] <= boxes[b][1][axis];
                }
                if (is_common) expected.insert(static_cast<std::int32_t>(b));
            }
            EXPECT_EQ(found, expected);
        }
    }
    BoxGrid().for_each_overlap({}, [](std::int32_t) { ADD_FAILURE(); });
}

TEST(InsideTest, KnowsATorusAndACube) {
    const InsideTest ring(torus({0, 0, 0}, 1, 0.3, 60, 30)), cube(cuboid({-1, -1, -1}, {2, 2, 2}));
    std::mt19937 random(2);
    std::uniform_real_distribution<double> uniform(-1.4, 1.4);
    for (int k = 0; k < 5000; ++k) {
        const Point p{uniform(random), uniform(random), uniform(random)};
        const double from_axis = std::hypot(std::hypot(p[0], p[1]) - 1, p[2]);
        // Between the inscribed and the circumscribed ring the triangles decide.
        const double sagitta =
            1.3 * (1 - std::cos(std::numbers::pi / 60)) + 0.3 * (1 - std::cos(std::numbers::pi / 30));
        if (std::abs(from_axis - 0.3) > sagitta) {
            EXPECT_EQ(ring.contains(p), from_axis < 0.3);
        }
        const double reach = std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
        EXPECT_EQ(cube.contains(p), reach < 1);
        EXPECT_NEAR(cube.winding_number(p), reach < 1 ? 1 : 0, 1e-12);
    }
}

TEST(InsideTest, IsNotConfusedByRaysThroughVerticesAndEdges) {
    const InsideTest ball(sphere({0, 0, 0}, 1, 3)), cube(cuboid({0, 0, 0}, {1, 1, 1}));
    for (int i = -9; i <= 9; ++i) {
        for (int j = -9; j <= 9; ++j) {
            const Point p{i * 0.125, j * 0.125, 0};  // rays along the sphere's planes of vertices
            const double r = std::hypot(p[0], p[1]);
            if (r < 0.98 || r > 1) {
                EXPECT_EQ(ball.contains(p), r < 1) << p[0] << ' ' << p[1];
            }
            const Point on_diagonals{i * 0.125, i * 0.125, i * 0.125};
            const bool is_inside = i > 0 && i < 8;
            if (i != 0 && i != 8) {
                EXPECT_EQ(cube.contains(on_diagonals), is_inside);
            }
        }
    }
}

TEST(InsideTest, OpenSurfacesAreRefused) {
    TriangleMesh open = cuboid({0, 0, 0}, {1, 1, 1});
    open.triangles.pop_back();
    EXPECT_THROW(InsideTest{open}, Error);
    EXPECT_THROW(InsideTest{TriangleMesh{}}, Error);
}

}  // namespace
}  // namespace lancet::mesh::test
