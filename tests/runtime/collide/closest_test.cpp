// Closest points of segments and triangles, held against the condition that makes them so. With d from the first point
// x to the second y, both of convex sets, the distance is smallest exactly if no corner c of the first has
// (c - x) . d > 0 and none of the second has (c - y) . d < 0.
#include "lancet/runtime/collide/closest.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace lancet::runtime {
namespace {

/// Rounding of the products below for coordinates of size 1: some tens of operations, and once more for parameters
/// divided by squared lengths, whose error is largest for nearly parallel segments.
constexpr double tolerance = 1e-13;
/// Across a sliver the closest point is known to its height alone.
constexpr double sliver_height = 1e-9;

void expect_closest(std::span<const Point> first, const Point& x, std::span<const Point> second, const Point& y,
                    double distance, double height = 0) {
    const double bound = tolerance + 4 * height;
    const Point d = subtract(y, x);
    EXPECT_NEAR(length(d), distance, bound);
    for (const Point& corner : first) EXPECT_LE(dot(subtract(corner, x), d), bound);
    for (const Point& corner : second) EXPECT_GE(dot(subtract(corner, y), d), -bound);
}

class Samples {
  public:
    explicit Samples(unsigned seed) : random_(seed) {}
    /// In [-1, 1]^3; on a coarse grid in a third of the cases, so that points coincide and lines are parallel.
    Point point() {
        std::uniform_real_distribution<double> place(-1, 1);
        Point at{place(random_), place(random_), place(random_)};
        if (is_coarse_) {
            for (double& x : at) x = std::round(1.5 * x) / 2;
        }
        return at;
    }
    Segment segment() { return {point(), point()}; }
    TrianglePoints triangle() {
        TrianglePoints corners{point(), point(), point()};
        is_sliver_ = false;
        switch (kind_(random_)) {
            case 0:  // a line
                corners[2] = Segment{corners[0], corners[1]}.at(0.3);
                break;
            case 1:  // a point
                corners[1] = corners[2] = corners[0];
                break;
            case 2:  // nearly a line
                corners[2] = Segment{corners[0], corners[1]}.at(0.6);
                corners[2][1] += sliver_height;
                is_sliver_ = true;
                break;
            case 3:  // two corners at one place
                corners[2] = corners[1];
                break;
            default:
                break;
        }
        return corners;
    }
    /// Of the last triangle.
    double height() const { return is_sliver_ ? sliver_height : 0; }
    void next() { is_coarse_ = kind_(random_) < 3; }

  private:
    std::mt19937_64 random_;
    std::uniform_int_distribution<int> kind_{0, 9};
    bool is_coarse_ = false;
    bool is_sliver_ = false;
};

TEST(ClosestPoints, OfASegmentAndAPoint) {
    Samples samples(1);
    for (int i = 0; i < 2000; ++i) {
        samples.next();
        const Segment segment = samples.segment();
        const Point place = samples.point();
        const double parameter = closest_parameter(segment, place);
        const Point x = segment.at(parameter);
        expect_closest(std::vector{segment.start, segment.end}, x, std::vector{place}, place,
                       length(subtract(place, x)));
    }
    EXPECT_EQ(closest_parameter({{1, 1, 1}, {1, 1, 1}}, {0, 0, 0}), 0);
}

TEST(ClosestPoints, OfTwoSegments) {
    Samples samples(2);
    for (int i = 0; i < 5000; ++i) {
        samples.next();
        Segment a = samples.segment(), b = samples.segment();
        if (i % 7 == 0) b = {add_scaled(a.start, 0.1, b.start), add_scaled(a.end, 0.1, b.start)};  // parallel
        if (i % 11 == 0) b.end = b.start;
        const SegmentPair pair = closest_points(a, b);
        SCOPED_TRACE(i);
        expect_closest(std::vector{a.start, a.end}, a.at(pair.first), std::vector{b.start, b.end}, b.at(pair.second),
                       pair.distance);
    }
}

TEST(ClosestPoints, OfATriangleAndAPoint) {
    Samples samples(3);
    for (int i = 0; i < 5000; ++i) {
        samples.next();
        const TrianglePoints corners = samples.triangle();
        const Point place = samples.point();
        const TrianglePoint found = closest_point(corners, place);
        SCOPED_TRACE(i);
        expect_closest(corners, weighted(corners, found.weights), std::vector{place}, place, found.distance,
                       samples.height());
        double sum = 0;
        for (const double weight : found.weights) {
            EXPECT_GE(weight, 0);
            sum += weight;
        }
        EXPECT_NEAR(sum, 1, 1e-15);
    }
}

TEST(ClosestPoints, OfASegmentAndATriangle) {
    Samples samples(4);
    int pierced = 0;
    for (int i = 0; i < 20000; ++i) {
        samples.next();
        const TrianglePoints corners = samples.triangle();
        Segment segment = samples.segment();
        if (i % 13 == 0) segment.end = segment.start;
        const SegmentTriangle found = closest_points(segment, corners);
        SCOPED_TRACE(i);
        expect_closest(std::vector{segment.start, segment.end}, segment.at(found.parameter), corners,
                       weighted(corners, found.point.weights), found.point.distance, samples.height());
        pierced += found.pierces ? 1 : 0;
    }
    EXPECT_GT(pierced, 500);
}

TEST(ClosestPoints, FarAwayAreAsGoodAsTheirCoordinates) {
    // 1e8 m away coordinates are known to 1.5e-8 m, and so are distances of the size of metres.
    const Point shift{1e8, -1e8, 1e8};
    Samples samples(5);
    for (int i = 0; i < 1000; ++i) {
        samples.next();
        TrianglePoints corners = samples.triangle();
        Segment segment = samples.segment();
        for (Point& corner : corners) corner = add(corner, shift);
        segment = {add(segment.start, shift), add(segment.end, shift)};
        TrianglePoints back = corners;
        for (Point& corner : back) corner = subtract(corner, shift);
        const SegmentTriangle here =
            closest_points({subtract(segment.start, shift), subtract(segment.end, shift)}, back);
        EXPECT_NEAR(closest_points(segment, corners).point.distance, here.point.distance, 1e-7);
    }
}

TEST(ClosestPoints, HaveNormalsOnlyWhereTrianglesAreNotFlat) {
    EXPECT_EQ(unit_normal({Point{0, 0, 0}, {2, 0, 0}, {0, 3, 0}}), (Point{0, 0, 1}));
    EXPECT_EQ(unit_normal({Point{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}), (Point{0, 0, 0}));
    EXPECT_EQ(unit_normal({Point{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}), (Point{0, 0, 0}));
    EXPECT_EQ(unit_normal({Point{0, 0, 0}, {1, 0, 0}, {0.5, 1e-14, 0}}), (Point{0, 0, 0}));
    EXPECT_EQ(unit_normal({Point{0, 0, 0}, {1e-20, 0, 0}, {0, 1e-20, 0}}), (Point{0, 0, 1}));
    for (const Point& a : {Point{0, 0, 0}, {1, 2, 3}, {0, 0, -5}, {1e-200, 0, 0}}) {
        EXPECT_NEAR(length(perpendicular(a)), 1, 1e-15);
        EXPECT_NEAR(dot(perpendicular(a), a), 0, 1e-15);
    }
}

}  // namespace
}  // namespace lancet::runtime
