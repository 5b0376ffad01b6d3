#include "lancet/mesh/embed/embedding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/mesh/surface/shapes.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/generate/box.hpp"

namespace lancet::mesh::test {
namespace {

std::vector<Tetrahedron> nodes_of(const TetMesh& mesh, const Embedding& embedding) {
    std::vector<Tetrahedron> nodes;
    for (const std::int32_t element : embedding.elements) {
        nodes.push_back(mesh.tetrahedra()[static_cast<std::size_t>(element)]);
    }
    return nodes;
}

double distance(const Point& a, const Point& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

TEST(Embedding, AffineMotionsCarryPointsExactly) {
    for (const Split split : {Split::five, Split::six}) {
        const TetMesh body = box({.cells = {5, 4, 6}, .size = {1, 0.7, 1.3}, .split = split, .origin = {-0.2, 10, 3}});
        std::mt19937 random(3);
        std::uniform_real_distribution<double> uniform(-0.1, 1.1);
        std::vector<Point> points(body.nodes().begin(), body.nodes().end());  // on borders of elements, all of them
        for (int k = 0; k < 3000; ++k) {                                      // inside and outside
            points.push_back({-0.2 + uniform(random), 10 + 0.7 * uniform(random), 3 + 1.3 * uniform(random)});
        }
        const Embedding embedding = embed(body, points);
        const std::vector<Tetrahedron> nodes = nodes_of(body, embedding);
        std::vector<Point> places(points.size());
        place(nodes, embedding.weights, body.nodes(), places);
        // Weights are quotients of volumes of differences: a few roundings of coordinates near ten.
        for (std::size_t p = 0; p < points.size(); ++p) EXPECT_LT(distance(places[p], points[p]), 1e-13);

        const auto moved = [](const Point& x) -> Point {
            return {1 + 2 * x[0] - x[1], 0.3 * x[0] + 0.1 * x[1] + 3 * x[2], -x[0] + x[2]};
        };
        std::vector<Point> positions;
        for (const Point& node : body.nodes()) positions.push_back(moved(node));
        const std::size_t half = points.size() / 2;  // in blocks
        for (const auto& [begin, count] : {std::pair(half, points.size() - half), std::pair(std::size_t{0}, half)}) {
            place(std::span(nodes).subspan(begin, count), std::span(embedding.weights).subspan(begin, count), positions,
                  std::span(places).subspan(begin, count));
        }
        for (std::size_t p = 0; p < points.size(); ++p) EXPECT_LT(distance(places[p], moved(points[p])), 1e-12);
    }
}

TEST(Embedding, PointsLieInTheirElementsOrNearThem) {
    const TetMesh body = box({.cells = {3, 3, 3}});
    const TriangleMesh ball = sphere({0.5, 0.5, 0.5}, 0.45, 3);
    const Embedding inside = embed(body, ball.vertices);
    for (std::size_t v = 0; v < ball.vertices.size(); ++v) {
        EXPECT_EQ(inside.distances[v], 0);
        for (const double weight : inside.weights[v]) EXPECT_GE(weight, 0);
    }
    const std::vector<Point> outside{{-2, 0.5, 0.4}, {1.5, 1.5, 1.5}, {0.3, 1 + 1e-9, 0.3}, {0.5, -1e6, 0.5}};
    const Embedding found = embed(body, outside);
    const std::array<double, 4> distances{2, std::sqrt(0.75), 1e-9, 1e6};
    for (std::size_t p = 0; p < outside.size(); ++p) {
        EXPECT_NEAR(found.distances[p], distances[p], 1e-15 + 1e-9 * distances[p]);
    }
    // The element at the nearest corner.
    const Tetrahedron& corner = body.tetrahedra()[static_cast<std::size_t>(found.elements[1])];
    EXPECT_NE(std::ranges::find(corner, static_cast<std::int32_t>(body.nodes().size()) - 1), corner.end());
}

TEST(Embedding, TheNearestOfAllElementsIsFound) {
    const TetMesh body = box({.cells = {4, 2, 3}, .split = Split::six});
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1.5, 2.5);
    std::vector<Point> points;
    for (int k = 0; k < 200; ++k) points.push_back({uniform(random), uniform(random), uniform(random)});
    const Embedding found = embed(body, points);
    for (std::size_t p = 0; p < points.size(); ++p) {
        Point outside{};  // the distance to the box, which the elements fill
        for (std::size_t axis = 0; axis < 3; ++axis) {
            outside[axis] = std::max({-points[p][axis], points[p][axis] - 1, 0.0});
        }
        EXPECT_NEAR(found.distances[p], std::hypot(outside[0], outside[1], outside[2]), 1e-14);
    }
}

TEST(Embedding, BadInputIsRefused) {
    const std::vector<Point> good{{0, 0, 0}}, bad{{0, 0, 0}, {0, std::numeric_limits<double>::infinity(), 0}};
    EXPECT_THROW(embed(TetMesh(), good), Error);
    EXPECT_THROW(embed(box({}), bad), Error);
    EXPECT_THROW(embed(box({}), std::vector<Point>{{1.7e308, -1.7e308, 0}}), Error);
    EXPECT_TRUE(embed(box({}), {}).elements.empty());
}

}  // namespace
}  // namespace lancet::mesh::test
