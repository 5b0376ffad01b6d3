#include "lancet/mesh/embed/polygon_triangles.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace lancet::mesh::test {
namespace {

using Loops = std::vector<std::vector<std::int32_t>>;

/// How often each directed side is there more than its opposite.
std::map<std::pair<std::int32_t, std::int32_t>, int> excess(const Loops& loops) {
    std::map<std::pair<std::int32_t, std::int32_t>, int> sides;
    for (const auto& loop : loops) {
        for (std::size_t k = 0; k < loop.size(); ++k) {
            const std::int32_t a = loop[k], b = loop[(k + 1) % loop.size()];
            sides[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
        }
    }
    std::erase_if(sides, [](const auto& side) { return side.second == 0; });
    return sides;
}

Loops as_loops(const std::vector<Triangle>& triangles) {
    Loops loops;
    for (const Triangle& t : triangles) loops.push_back({t.begin(), t.end()});
    return loops;
}

/// Adds a regular polygon around a centre; the plane is tilted.
std::vector<std::int32_t> ring(std::vector<Point>& places, double x, double y, double radius, int count, bool is_hole) {
    std::vector<std::int32_t> loop;
    for (int k = 0; k < count; ++k) {
        const double angle = (is_hole ? -2 : 2) * std::numbers::pi * k / count;
        const double u = x + radius * std::cos(angle), v = y + radius * std::sin(angle);
        loop.push_back(static_cast<std::int32_t>(places.size()));
        places.push_back({u, 0.6 * v, 0.8 * v});
    }
    return loop;
}

constexpr Point normal{0, -0.8, 0.6};

double area_of(int count, double radius) {
    return count / 2.0 * radius * radius * std::sin(2 * std::numbers::pi / count);
}

TEST(PolygonTriangles, FillRegionsWithHolesAndIslands) {
    std::vector<Point> places;
    const Loops loops{ring(places, 0, 0, 3, 20, false), ring(places, 1, 0.3, 1.2, 12, true),
                      ring(places, -1.5, 0, 0.5, 7, true), ring(places, 1, 0.3, 0.7, 9, false),
                      ring(places, 7, 1, 2, 5, false)};
    std::vector<Triangle> triangles;
    add_triangles(loops, places, normal, triangles);
    EXPECT_EQ(excess(as_loops(triangles)), excess(loops));
    double sum = 0;
    for (const auto& [a, b, c] : triangles) {
        const Point &p = places[static_cast<std::size_t>(a)], &q = places[static_cast<std::size_t>(b)],
                    &r = places[static_cast<std::size_t>(c)];
        // None is turned over, so that nothing is covered twice.
        EXPECT_GT(signed_volume(p, q, r, {p[0], p[1] + normal[1], p[2] + normal[2]}), 0);
        sum += area(p, q, r);
    }
    EXPECT_NEAR(sum, area_of(20, 3) - area_of(12, 1.2) - area_of(7, 0.5) + area_of(9, 0.7) + area_of(5, 2), 1e-12);
}

TEST(PolygonTriangles, ConcaveRegionsWithCornersInTheMiddleOfSides) {
    // A comb; its lower side has a corner under every tooth.
    std::vector<Point> places;
    std::vector<std::int32_t> loop;
    const auto add = [&](double x, double y) {
        loop.push_back(static_cast<std::int32_t>(places.size()));
        places.push_back({x, 0.6 * y, 0.8 * y});
    };
    constexpr int teeth = 6;
    for (int k = 0; k <= 2 * teeth; ++k) add(k, 0);
    for (int k = 2 * teeth; k >= 0; --k) add(k, k % 2 == 0 ? 1 : 3);
    std::vector<Triangle> triangles;
    add_triangles(Loops{loop}, places, normal, triangles);
    EXPECT_EQ(excess(as_loops(triangles)), excess({loop}));
    double sum = 0;
    for (const auto& [a, b, c] : triangles) {
        const double one = area(places[static_cast<std::size_t>(a)], places[static_cast<std::size_t>(b)],
                                places[static_cast<std::size_t>(c)]);
        EXPECT_GT(one, 0.1);  // no triangle lies on a side
        sum += one;
    }
    EXPECT_NEAR(sum, 4 * teeth, 1e-12);
}

TEST(PolygonTriangles, KeepTheBorderWhateverThePlacesAre) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int trial = 0; trial < 300; ++trial) {
        std::vector<Point> places;
        Loops loops(1 + random() % 3);
        for (auto& loop : loops) {
            const std::size_t count = 3 + random() % 10;
            for (std::size_t k = 0; k < count; ++k) {
                loop.push_back(static_cast<std::int32_t>(places.size()));
                // Crossing themselves, in lines, in one place.
                places.push_back({uniform(random), trial % 3 == 0 ? 0 : uniform(random), 0});
                if (trial % 5 == 0) places.back() = {0.5, 0.5, 0};
            }
        }
        std::vector<Triangle> triangles;
        add_triangles(loops, places, {0, 0, 1}, triangles);
        EXPECT_EQ(excess(as_loops(triangles)), excess(loops));
    }
}

}  // namespace
}  // namespace lancet::mesh::test
