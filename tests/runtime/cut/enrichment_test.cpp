#include "lancet/runtime/cut/enrichment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {
namespace {

using mesh::Point;

constexpr std::array all_enrichments{Enrichment::substituted, Enrichment::shifted, Enrichment::heaviside};
constexpr double epsilon = std::numeric_limits<double>::epsilon();

Point random_point(std::mt19937& random) {
    std::uniform_real_distribution<double> value(-1.0, 1.0);
    return {value(random), value(random), value(random)};
}

/// psi of the enrichment on side H, for a node on side H_i.
double psi(Enrichment enrichment, int h, int h_node) {
    return enrichment == Enrichment::shifted ? (h - h_node) / 2.0 : h;
}

TEST(Enrichment, TwoCopiesAreTheNodesValuePlusPsiTimesA) {
    std::mt19937 random(1);
    for (const Enrichment enrichment : {Enrichment::shifted, Enrichment::heaviside}) {
        for (const int h_node : {1, -1}) {
            const Point u = random_point(random), a = random_point(random);
            std::array<Point, 2> values{u, a};
            enriched_to_copies(enrichment, std::array{CopyLevel{0, h_node}}, values);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                // One product with +-1 or 0 and one sum: the same roundings.
                EXPECT_EQ(values[0][axis], u[axis] + psi(enrichment, h_node, h_node) * a[axis]);
                EXPECT_EQ(values[1][axis], u[axis] + psi(enrichment, -h_node, h_node) * a[axis]);
            }
        }
    }
}

TEST(Enrichment, TheShiftedOneIsTheNodesOwnCopyAndTheJump) {
    const Point plus{3, 1, -4}, minus{1, -5, 9};
    for (const int h_node : {1, -1}) {
        std::array<Point, 2> values{h_node == 1 ? plus : minus, h_node == 1 ? minus : plus};
        copies_to_enriched(Enrichment::shifted, std::array{CopyLevel{0, h_node}}, values);
        EXPECT_EQ(values[0], h_node == 1 ? plus : minus);
        EXPECT_EQ(values[1], (Point{2, 6, -13}));
        values = {h_node == 1 ? plus : minus, h_node == 1 ? minus : plus};
        copies_to_enriched(Enrichment::heaviside, std::array{CopyLevel{0, h_node}}, values);
        EXPECT_EQ(values[0], (Point{2, -2, 2.5}));
        EXPECT_EQ(values[1], (Point{1, 3, -6.5}));
    }
}

TEST(Enrichment, ThereAndBackIsTheSameToRounding) {
    std::mt19937 random(2);
    for (const Enrichment enrichment : all_enrichments) {
        SCOPED_TRACE(to_string(enrichment));
        for (std::size_t copies = 1; copies <= 8; ++copies) {
            std::vector<CopyLevel> levels;
            for (std::size_t k = 1; k < copies; ++k) {
                levels.push_back({static_cast<int>(random() % k), random() % 2 == 0 ? 1 : -1});
            }
            std::vector<Point> values(copies);
            for (Point& value : values) value = random_point(random);
            const std::vector<Point> start = values;
            const auto expect_start = [&] {
                for (std::size_t k = 0; k < copies; ++k) {
                    for (std::size_t axis = 0; axis < 3; ++axis) {
                        // Each of at most 7 levels rounds sums of numbers up to 8 in two directions.
                        EXPECT_NEAR(values[k][axis], start[k][axis], 2 * 7 * 8 * epsilon);
                    }
                }
            };
            copies_to_enriched(enrichment, levels, values);
            enriched_to_copies(enrichment, levels, values);
            expect_start();
            enriched_to_copies(enrichment, levels, values);
            copies_to_enriched(enrichment, levels, values);
            expect_start();
            if (enrichment == Enrichment::substituted) {
                EXPECT_EQ(values, start);
            }
        }
    }
}

TEST(Enrichment, ABodyThatMovesRigidlyHasNoOpening) {
    const std::array levels{CopyLevel{0, 1}, CopyLevel{1, -1}, CopyLevel{0, -1}};
    for (const Enrichment enrichment : {Enrichment::shifted, Enrichment::heaviside}) {
        const Point motion{0.1, 0.2, 0.3};
        std::array<Point, 4> values{motion, motion, motion, motion};
        copies_to_enriched(enrichment, levels, values);
        EXPECT_EQ(values[0], motion);
        for (std::size_t k = 1; k < 4; ++k) EXPECT_EQ(values[k], Point{});
    }
}

TEST(Enrichment, FurtherCutsAddLevels) {
    // A node in the first of three layers A | B | C, cut first between A and B, then between B and C. H = +1 is the
    // side of A, and then that of B. The further cut does not reach the node's own copy.
    const double a = 1, b = 10, c = 100;
    const std::array levels{CopyLevel{0, 1}, CopyLevel{1, 1}};
    std::array<Point, 3> values{Point{a, 0, 0}, Point{b, 0, 0}, Point{c, 0, 0}};
    copies_to_enriched(Enrichment::shifted, levels, values);
    EXPECT_EQ(values[0][0], a);
    EXPECT_EQ(values[1][0], a - b);
    EXPECT_EQ(values[2][0], b - c);
    values = {Point{a, 0, 0}, Point{b, 0, 0}, Point{c, 0, 0}};
    copies_to_enriched(Enrichment::heaviside, levels, values);
    EXPECT_EQ(values[0][0], (a + (b + c) / 2) / 2);
    EXPECT_EQ(values[1][0], (a - (b + c) / 2) / 2);
    EXPECT_EQ(values[2][0], (b - c) / 2);
}

TEST(Enrichment, RefusesWhatDoesNotGoTogether) {
    std::array<Point, 3> values{};
    const auto refused = [&](std::vector<CopyLevel> levels) {
        EXPECT_THROW(copies_to_enriched(Enrichment::shifted, levels, values), Error);
        EXPECT_THROW(enriched_to_copies(Enrichment::shifted, levels, values), Error);
    };
    refused({});
    refused({{0, 1}, {0, 1}, {0, 1}});
    refused({{1, 1}, {0, 1}});
    refused({{0, 1}, {-1, 1}});
    refused({{0, 1}, {0, 0}});
    EXPECT_THROW(copies_to_enriched(Enrichment::shifted, {}, {}), Error);
}

TEST(Enrichment, KindsHaveNames) {
    for (const Enrichment enrichment : all_enrichments) {
        EXPECT_EQ(enrichment_from_string(to_string(enrichment)), enrichment);
    }
    EXPECT_THROW(enrichment_from_string("corrected"), Error);
}

}  // namespace
}  // namespace lancet::runtime
