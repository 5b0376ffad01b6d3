// A blade that is drawn through bodies at rest and in motion.
#include "lancet/runtime/cut/blade.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/components.hpp"
#include "lancet/mesh/generate/box.hpp"

namespace lancet::test {
namespace {

using mesh::Point;
using runtime::Blade;
using runtime::CuttableBody;

runtime::Scene bar() {
    runtime::Scene scene;
    scene.mesh = mesh::box({.cells = {10, 2, 2}, .size = {1, 0.2, 0.2}});
    scene.materials = {{0, {.young_modulus = 2e6, .poisson_ratio = 0.33, .density = 500}}};
    const auto left = scene.mesh.node_set("x_min");
    scene.fixed_nodes.assign(left.begin(), left.end());
    return scene;
}

int pieces(const CuttableBody& body) {
    return mesh::components(body.mesh().node_of_copy().size(), body.mesh().parts()).count;
}

/// The largest first.
std::vector<double> volumes_of_pieces(const CuttableBody& body) {
    const auto components = mesh::components(body.mesh().node_of_copy().size(), body.mesh().parts());
    std::vector<double> volumes(static_cast<std::size_t>(components.count));
    for (std::size_t part = 0; part < body.mesh().parts().size(); ++part) {
        volumes[static_cast<std::size_t>(components.of_element[part])] +=
            body.mesh().moments(static_cast<std::int32_t>(part)).fraction *
            body.mesh().mesh().volume(body.mesh().element_of_part()[part]);
    }
    std::ranges::sort(volumes, std::ranges::greater{});
    return volumes;
}

TEST(Blade, RestPlacesAreFoundInsideAndOutside) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    CuttableBody body(bar(), {}, *scheduler);
    // Turned by 90 degrees about z and stretched by a tenth along x: x' = -y, y' = 1.1 x.
    std::vector<Point> positions;
    for (const Point& x : body.mesh().mesh().nodes()) positions.push_back({-x[1], 1.1 * x[0], x[2]});
    const std::vector<Point> rest{{0.33, 0.07, 0.11}, {0.99, 0.199, 0.001}, {1.5, 0.1, 0.1}, {0.4, 0.5, 0.1}};
    std::vector<Point> places;
    for (const Point& x : rest) places.push_back({-x[1], 1.1 * x[0], x[2]});
    const std::vector<Point> found = rest_places(body, positions, places);
    ASSERT_EQ(found.size(), rest.size());
    for (std::size_t k = 0; k < rest.size(); ++k) {
        for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(found[k][axis], rest[k][axis], 1e-12);
    }
}

// The part whose box is nearest, and of those the one that holds the place deepest, among all there are.
TEST(Blade, RestPlacesAreThoseOfTheNearestOfAllParts) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    const CuttableBody body(bar(), {}, *scheduler);
    const mesh::TetMesh& mesh = body.mesh().mesh();
    // Bent, so that every element takes a place outside of the body elsewhere.
    std::vector<Point> positions;
    for (const Point& x : mesh.nodes()) {
        positions.push_back({x[0] + 0.3 * x[1] * x[1], x[1] + 0.4 * x[0] * x[0], x[2] * (1 + 0.2 * x[0])});
    }
    std::mt19937 generator(5);
    std::vector<Point> places;
    for (int k = 0; k < 200; ++k) {
        const double spread = k % 4 == 0 ? 10 : k % 4 == 1 ? 1 : 0.1;
        std::uniform_real_distribution<double> uniform(-spread, spread);
        places.push_back({0.5 + uniform(generator), 0.1 + uniform(generator), 0.1 + uniform(generator)});
    }
    const std::vector<Point> found = rest_places(body, positions, places);
    for (std::size_t k = 0; k < places.size(); ++k) {
        std::pair<double, double> best{INFINITY, INFINITY};
        Point expected{};
        for (const mesh::Tetrahedron& nodes : mesh.tetrahedra()) {
            std::array<Point, 4> corners{};
            for (std::size_t i = 0; i < 4; ++i) corners[i] = positions[static_cast<std::size_t>(nodes[i])];
            double square = 0;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const auto [low, high] =
                    std::minmax({corners[0][axis], corners[1][axis], corners[2][axis], corners[3][axis]});
                square += std::pow(std::max({low - places[k][axis], places[k][axis] - high, 0.0}), 2);
            }
            const mesh::Barycentric weights = mesh::barycentric(corners, places[k]);
            const std::pair<double, double> here{square, -*std::ranges::min_element(weights)};
            if (here >= best) continue;
            best = here;
            expected = {};
            for (std::size_t i = 0; i < 4; ++i) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    expected[axis] += weights[i] * mesh.nodes()[static_cast<std::size_t>(nodes[i])][axis];
                }
            }
        }
        EXPECT_EQ(found[k], expected) << "place " << k;
    }
}

TEST(Blade, StrokesThroughABodyAtRestAreOneSurface) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    CuttableBody body(bar(), {}, *scheduler);
    Blade blade(4);
    EXPECT_EQ(blade.draw(body, *scheduler, {0.43, 0.3, -0.1}, {0.44, 0.3, 0.3}).mesh.touched_elements, 0);
    for (int stroke = 1; stroke <= 20; ++stroke) {
        EXPECT_EQ(pieces(body), 1) << "before stroke " << stroke;
        const double y = 0.3 - 0.0173 * stroke;
        blade.draw(body, *scheduler, {0.43, y, -0.1}, {0.44, y, 0.3});
        if (y < 0) break;
    }
    EXPECT_EQ(pieces(body), 2);
}

// While the bar swings and is dragged aside by what it has lost: in space the strokes would leave gaps.
TEST(Blade, StrokesThroughAMovingBodyLeaveNoGap) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    for (const auto fronts : {mesh::Fronts::sharp, mesh::Fronts::blended}) {
        CuttableBody body(bar(), {.time_step = 0.01}, *scheduler, {.fronts = fronts});
        Blade blade;
        bool is_apart = false;
        for (int step = 0; step < 60 && !is_apart; ++step) {
            const double y = 0.25 - 0.02 * step;
            blade.draw(body, *scheduler, {0.5, y, -0.1}, {0.5, y, 0.3});
            EXPECT_FALSE(body.step(*scheduler).lost);
            const std::vector<double> volumes = volumes_of_pieces(body);
            is_apart = volumes.size() > 1 && volumes[1] > 0.01;  // what is smaller are crumbs
        }
        EXPECT_TRUE(is_apart);
        EXPECT_NEAR(volumes_of_pieces(body)[0], 0.02, 0.002);
    }
}

TEST(Blade, SmallMovesAreGatheredIntoStrokes) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    CuttableBody body(bar(), {}, *scheduler);
    Blade blade(4, 0.1);
    int strokes = 0;
    for (int k = 0; k <= 1200; ++k) {
        const double y = 0.35 - 0.0005 * k;
        strokes += blade.draw(body, *scheduler, {0.43, y, -0.1}, {0.44, y, 0.3}).mesh.touched_elements > 0 ? 1 : 0;
    }
    EXPECT_EQ(pieces(body), 2);
    EXPECT_LE(strokes, 4) << "0.2 m of material in strokes of 0.1 m";
    EXPECT_THROW(Blade(4, -1), Error);
    EXPECT_THROW(Blade(4, NAN), Error);
}

TEST(Blade, BadNumbersAreRefusedAndLoseNothing) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    CuttableBody body(bar(), {}, *scheduler);
    EXPECT_THROW(Blade(0), Error);
    Blade blade;
    blade.place(body, {0.5, 0.3, -0.1}, {0.5, 0.3, 0.3});
    EXPECT_THROW(blade.draw(body, *scheduler, {0.5, NAN, -0.1}, {0.5, 0.1, 0.3}), Error);
    blade.draw(body, *scheduler, {0.5, -0.1, -0.1}, {0.5, -0.1, 0.3});
    EXPECT_EQ(pieces(body), 2);
}

}  // namespace
}  // namespace lancet::test
