// Tools: where poses put them, how far other things are, and that no motion is too fast to be seen.
#include "lancet/runtime/collide/tool_shape.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {
namespace {

std::array<double, 4> turn(const Point& axis, double angle) {
    const Point unit = direction(axis);
    return {std::cos(angle / 2), std::sin(angle / 2) * unit[0], std::sin(angle / 2) * unit[1],
            std::sin(angle / 2) * unit[2]};
}

std::vector<Segment> axis_of(const ToolShape& shape, const Pose& pose) {
    std::vector<Segment> axis(segments(shape));
    place_axis(shape, pose, axis);
    return axis;
}

void expect_point(const Point& found, const Point& expected, double tolerance = 1e-15) {
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found[i], expected[i], tolerance);
}

TEST(ToolShape, IsTurnedAndThenMoved) {
    const Pose pose{{10, 0, 0}, turn({0, 0, 1}, std::numbers::pi / 2)};
    const auto axis = axis_of(ChainTool{{{0, 0, 0}, {1, 0, 0}, {1, 0, 2}}, 0.1}, pose);
    ASSERT_EQ(axis.size(), 2U);
    expect_point(axis[0].start, {10, 0, 0});
    expect_point(axis[0].end, {10, 1, 0});
    expect_point(axis[1].end, {10, 1, 2});
    const auto sphere = axis_of(SphereTool{0.1, {0, 2, 0}}, pose);
    expect_point(sphere.front().start, {8, 0, 0});
    expect_point(sphere.front().end, {8, 0, 0});
    EXPECT_EQ(axis_of(ChainTool{{{1, 2, 3}}, 0.1}, {}).front().end, (Point{1, 2, 3}));
}

TEST(ToolShape, DistancesOfASphereAreThoseOfItsCentre) {
    const auto axis = axis_of(SphereTool{0.5}, {{1, 2, 3}});
    const auto beside = tool_distance(axis, 0.5, Point{1, 4, 3});
    EXPECT_DOUBLE_EQ(beside.distance, 1.5);
    expect_point(beside.on_tool, {1, 2.5, 3});
    expect_point(beside.normal, {0, -1, 0});
    EXPECT_DOUBLE_EQ(tool_distance(axis, 0.5, Point{1, 2.25, 3}).distance, -0.25);
    const auto at_centre = tool_distance(axis, 0.5, Point{1, 2, 3});
    EXPECT_DOUBLE_EQ(at_centre.distance, -0.5);
    EXPECT_NEAR(length(at_centre.normal), 1, 1e-15);
    EXPECT_DOUBLE_EQ(tool_distance(axis, 0.5, TrianglePoints{Point{0, 4, 2}, {3, 4, 2}, {1, 4, 6}}).distance, 1.5);
    EXPECT_DOUBLE_EQ(tool_distance(axis, 0.5, Segment{{-9, 2, 4}, {9, 2, 4}}).distance, 0.5);
}

TEST(ToolShape, DistancesOfAChainAreTheSmallestOfItsSegments) {
    const ChainTool chain{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, 0.1};
    const auto axis = axis_of(chain, {});
    const auto near_second = tool_distance(axis, chain.radius, Point{1.5, 0.5, 0});
    EXPECT_EQ(near_second.segment, 1U);
    EXPECT_DOUBLE_EQ(near_second.parameter, 0.5);
    EXPECT_DOUBLE_EQ(near_second.distance, 0.4);
    EXPECT_EQ(tool_distance(axis, chain.radius, Point{0.5, -0.5, 0}).segment, 0U);
    // Crossing a triangle: the axis is at distance zero, and the normal is one of those at right angles to it.
    const auto pierced =
        tool_distance(axis, chain.radius, TrianglePoints{Point{0.5, -1, -1}, {0.5, 2, -1}, {0.5, 0, 3}});
    EXPECT_DOUBLE_EQ(pierced.distance, -0.1);
    EXPECT_NEAR(length(pierced.normal), 1, 1e-15);
    EXPECT_NEAR(pierced.normal[0], 0, 1e-15);
}

TEST(ToolShape, TheClosestPointOfTheSurfaceIsAsFarAsTheDistance) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> place(-1, 1);
    const auto point = [&] { return Point{place(random), place(random), place(random)}; };
    for (int i = 0; i < 500; ++i) {
        const CapsuleTool capsule{point(), point(), 0.2};
        const Pose pose{point(), turn(point(), 3 * place(random))};
        const auto axis = axis_of(capsule, pose);
        // A rigid motion changes no length.
        EXPECT_NEAR(length(subtract(axis[0].end, axis[0].start)), length(subtract(capsule.end, capsule.start)), 1e-14);
        const auto found = tool_distance(axis, capsule.radius, TrianglePoints{point(), point(), point()});
        EXPECT_NEAR(length(subtract(found.on_tool, found.on_other)), std::abs(found.distance), 1e-14);
        EXPECT_NEAR(dot(subtract(found.on_tool, found.on_other), found.normal), found.distance, 1e-14);
    }
}

TEST(ToolPose, IsInterpolatedOnTheShorterArc) {
    const Pose from{{0, 0, 0}, turn({0, 0, 1}, 0.2)}, to{{2, 0, 0}, turn({0, 0, 1}, 1.4)};
    Pose negative = to;
    for (double& entry : negative.orientation) entry = -entry;
    for (const Pose& end : {to, negative}) {
        const Pose half = interpolate(from, end, 0.5), expected{{1, 0, 0}, turn({0, 0, 1}, 0.8)};
        expect_point(place(half, {1, 2, 3}), place(expected, {1, 2, 3}), 1e-14);
        expect_point(place(interpolate(from, end, 1), {1, 2, 3}), place(to, {1, 2, 3}), 1e-14);
    }
    EXPECT_EQ(interpolate(from, from, 0.3).orientation, from.orientation);
}

TEST(ToolMotion, MovesTheAxisByHalfOfTheRadiusAtMost) {
    const ChainTool chain{{{0, 0, 0.3}, {1, 0, 0}, {1, 1, 0}}, 0.02};
    const Pose from{{0, 0, 0}, turn({1, 2, 3}, -0.3)}, to{{0.5, -1, 0.25}, turn({3, -1, 1}, 1.8)};
    ToolMotion motion;
    motion.set(chain, from, to);
    EXPECT_GT(motion.poses(), 100U);
    const auto expect_axis = [&](std::size_t pose, const Pose& expected) {
        const auto axis = axis_of(chain, expected);
        for (std::size_t i = 0; i < axis.size(); ++i) {
            expect_point(motion.axis(pose)[i].start, axis[i].start, 1e-14);
            expect_point(motion.axis(pose)[i].end, axis[i].end, 1e-14);
        }
    };
    expect_axis(0, from);
    expect_axis(motion.poses() - 1, to);
    for (std::size_t pose = 1; pose < motion.poses(); ++pose) {
        for (std::size_t i = 0; i < 2; ++i) {
            for (const double parameter : {0.0, 0.4, 1.0}) {
                const Point step = subtract(motion.axis(pose)[i].at(parameter), motion.axis(pose - 1)[i].at(parameter));
                EXPECT_LE(length(step), chain.radius / 2 * (1 + 1e-12));
            }
        }
    }
    motion.set(chain, to);
    EXPECT_EQ(motion.poses(), 1U);
    expect_axis(0, to);
}

TEST(ToolMotion, RefusesWhatMakesNoSense) {
    const auto expect_error = [](const ToolShape& shape, const Pose& from, const Pose& to, const std::string& text) {
        try {
            ToolMotion().set(shape, from, to);
            FAIL() << "expected: " << text;
        } catch (const Error& error) {
            EXPECT_THAT(error.what(), ::testing::HasSubstr(text));
        }
    };
    const double not_a_number = std::nan("");
    expect_error(SphereTool{0}, {}, {}, "radius is 0.0");
    expect_error(SphereTool{-1}, {}, {}, "expected a positive length");
    expect_error(SphereTool{not_a_number}, {}, {}, "expected a positive length");
    expect_error(SphereTool{1, {not_a_number, 0, 0}}, {}, {}, "axis is not finite");
    expect_error(CapsuleTool{{0, 0, 0}, {HUGE_VAL, 0, 0}, 1}, {}, {}, "axis is not finite");
    expect_error(ChainTool{{}, 1}, {}, {}, "without points");
    expect_error(SphereTool{1}, {{0, not_a_number, 0}}, {}, "position is not finite");
    expect_error(SphereTool{1}, {}, {{0, 0, 0}, {0, 0, 0, 0}}, "unit quaternion");
    expect_error(SphereTool{0.01}, {}, {{100, 0, 0}}, "expected no more than");
}

}  // namespace
}  // namespace lancet::runtime
