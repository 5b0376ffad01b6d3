// Tools in surfaces: how deep, where, in which direction; and what is defined where geometry is bad.
#include "lancet/runtime/collide/tool_contact.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/runtime/collide/contact_meshes.hpp"
#include <gtest/gtest.h>

namespace lancet::runtime {
namespace {

using testing::Surface;
using testing::surface_of;

/// A box of [0, 1]^3 whose triangles are unlike on all sides.
Surface unit_cube(int cells = 5) {
    return surface_of(mesh::box({.cells = {cells, cells, cells}}));
}

std::vector<ToolContact> contacts_of(const Surface& surface, const ToolShape& shape, const Pose& from, const Pose& to) {
    ToolMotion motion;
    motion.set(shape, from, to);
    std::vector<ToolContact> contacts;
    ToolContactFinder().find(*surface.boxes, surface.positions, surface.triangles, motion, contacts);
    return contacts;
}
std::vector<ToolContact> contacts_of(const Surface& surface, const ToolShape& shape, const Pose& pose = {}) {
    return contacts_of(surface, shape, pose, pose);
}

double largest_depth(const std::vector<ToolContact>& contacts) {
    double depth = 0;
    for (const ToolContact& contact : contacts) depth = std::max(depth, contact.depth);
    return depth;
}

Point total(const std::vector<ToolContact>& contacts) {
    Point sum{};
    for (const ToolContact& contact : contacts) {
        sum = add_scaled(sum, contact.share * contact.depth, contact.normal);
    }
    return sum;
}

double distance_to_unit_cube(const Point& place) {
    Point beside{};
    for (std::size_t axis = 0; axis < 3; ++axis) beside[axis] = std::max({-place[axis], place[axis] - 1, 0.0});
    return length(beside);
}

TEST(ToolContact, OfASphereOutsideOfAConvexBodyIsAsDeepAsItsDistanceSays) {
    const Surface cube = unit_cube();
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> place(-0.4, 1.4);
    int touching = 0;
    for (int i = 0; i < 3000; ++i) {
        const SphereTool sphere{0.15};
        const Pose pose{{place(random), place(random), place(random)}};
        const double distance = distance_to_unit_cube(pose.position);
        if (distance < 1e-3) continue;  // on the surface or inside
        const auto contacts = contacts_of(cube, sphere, pose);
        EXPECT_EQ(contacts.empty(), distance >= sphere.radius);
        if (contacts.empty()) continue;
        ++touching;
        EXPECT_NEAR(largest_depth(contacts), sphere.radius - distance, 1e-14);
        for (const ToolContact& contact : contacts) {
            EXPECT_GT(contact.depth, 0);
            EXPECT_GT(contact.share, 0);
            EXPECT_LE(contact.share, 1 + 1e-14);
            EXPECT_NEAR(length(contact.normal), 1, 1e-14);
            // The centre lies along the normal.
            const Point back = add_scaled(contact.place, sphere.radius - contact.depth, contact.normal);
            EXPECT_LT(length(subtract(back, pose.position)), 1e-14);
            Point weighted{};
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const std::int32_t node = cube.triangles[contact.triangle][corner];
                weighted = add_scaled(weighted, contact.weights[corner], cube.positions[node]);
            }
            EXPECT_LT(length(subtract(weighted, contact.place)), 1e-15);
        }
        EXPECT_TRUE(std::ranges::is_sorted(contacts, {}, &ToolContact::triangle));
    }
    EXPECT_GT(touching, 500);
}

TEST(ToolContact, WhoseAxisIsBelowTheSurfacePointsOutOfIt) {
    const Surface cube = unit_cube();
    // Below the inside of a triangle, an edge, and a corner; and seen from all of them as deep as it is.
    for (const Point& place : {Point{0.43, 0.56, 0.95}, {0.4, 0.53, 0.95}, {0.4, 0.6, 0.95}, {0.5, 0.5, 0.93}}) {
        const auto contacts = contacts_of(cube, SphereTool{0.15}, {place});
        ASSERT_FALSE(contacts.empty());
        EXPECT_GT(total(contacts)[2], 0.15 + 1 - place[2] - 1e-14);
        bool is_straight = false;
        for (const ToolContact& contact : contacts) {
            EXPECT_GT(contact.normal[2], 0);
            is_straight = is_straight || (std::abs(contact.normal[2] - 1) < 1e-14 &&
                                          std::abs(contact.depth - (0.15 + 1 - place[2])) < 1e-14 &&
                                          std::abs(contact.share - 1) < 1e-14);
        }
        EXPECT_TRUE(is_straight);
    }
}

TEST(ToolContact, WhoseAxisIsInsideOfAConvexBodyNeverPointsInwards) {
    const Surface cube = unit_cube();
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> component(0.001, 0.999);
    int found = 0;
    for (int i = 0; i < 2000; ++i) {
        const Point place{component(random), component(random), component(random)};
        double nearest = 1;
        for (const double x : place) nearest = std::min({nearest, x, 1 - x});
        const auto contacts = contacts_of(cube, SphereTool{0.15}, {place});
        EXPECT_EQ(contacts.empty(), nearest >= 0.15);
        double shallowest = 10;
        for (const ToolContact& contact : contacts) {
            ++found;
            EXPECT_GT(dot(contact.normal, subtract(contact.place, place)), 0);
            shallowest = std::min(shallowest, contact.depth);
        }
        if (!contacts.empty()) {
            EXPECT_NEAR(shallowest, 0.15 + nearest, 1e-14);
        }
    }
    EXPECT_GT(found, 1000);
}

TEST(ToolContact, OfANeedleIsAsDeepAsItsTip) {
    const Surface cube = unit_cube();
    const CapsuleTool needle{{0, 0, 0}, {0, 0, 1}, 0.01};
    double last = 0;
    for (const double tip : {1.005, 1.0, 0.999, 0.9, 0.4}) {
        const auto contacts = contacts_of(cube, needle, {{0.45, 0.52, tip}});
        ASSERT_FALSE(contacts.empty()) << tip;
        EXPECT_NEAR(largest_depth(contacts), needle.radius + 1 - tip, 1e-14);
        EXPECT_GT(largest_depth(contacts), last);
        last = largest_depth(contacts);
        for (const ToolContact& contact : contacts) EXPECT_NEAR(contact.normal[2], 1, 1e-14);
    }
}

TEST(ToolContact, IsNotMissedHoweverFastAndThin) {
    const Surface cube = unit_cube();
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> place(0.05, 0.95);
    for (int i = 0; i < 200; ++i) {
        const SphereTool sphere{0.004};
        // From above the top to somewhere in the middle.
        const Pose from{{place(random), place(random), 1.3}}, to{{place(random), place(random), 0.5}};
        EXPECT_TRUE(contacts_of(cube, sphere, to).empty());
        const auto contacts = contacts_of(cube, sphere, from, to);
        ASSERT_FALSE(contacts.empty()) << i;
        for (const ToolContact& contact : contacts) {
            EXPECT_NEAR(contact.normal[2], 1, 1e-14);
            EXPECT_NEAR(contact.depth, sphere.radius + 0.5, 1e-14);
            // It passed the surface there.
            const Segment way{from.position, to.position};
            EXPECT_LT(length(subtract(way.at(0.3 / 0.8), contact.place)), sphere.radius);
        }
        // Through the body: still pushed back, more than out at the other side.
        const auto through = contacts_of(cube, sphere, from, {{to.position[0], to.position[1], -0.001}});
        EXPECT_GT(total(through)[2], 0.9);
        // Beside the body.
        EXPECT_TRUE(contacts_of(cube, sphere, {{1.2, 0.5, 1.3}}, {{1.2, 0.5, 0.5}}).empty());
        // In, and out again.
        EXPECT_TRUE(contacts_of(cube, sphere, {{-0.5, 1.2, 0.5}}, {{0.3, 1.1, 0.5}}).empty());
    }
    // A blade's edge that is turned through the surface.
    const CapsuleTool edge{{0, -0.3, 0}, {0, 0.3, 0}, 0.004};
    const Pose start{{0.5, 0.5, 1.02}}, end{{0.5, 0.5, 1.02}, {std::cos(0.3), std::sin(0.3), 0, 0}};
    EXPECT_FALSE(contacts_of(cube, edge, start, end).empty());
}

TEST(ToolContact, OfAToolThatSlidesOverEdgesChangesContinuously) {
    const Surface cube = unit_cube(3);
    const SphereTool sphere{0.2};
    // A jump would stay as large however short the steps are; what is continuous falls with them.
    const auto slide = [&](const Point& from, const Point& to, int steps) {
        double largest = 0;
        Point last{};
        for (int i = 0; i <= steps; ++i) {
            const Point now = total(contacts_of(cube, sphere, {Segment{from, to}.at(static_cast<double>(i) / steps)}));
            if (i > 0) largest = std::max(largest, length(subtract(now, last)));
            last = now;
        }
        return largest;
    };
    const std::vector<Segment> ways{{{0.21, 0.33, 1.1}, {0.93, 0.87, 1.13}},  // over the top
                                    {{0.95, 0.4, 1.15}, {1.15, 0.45, 0.95}},  // around an edge
                                    {{0.9, 0.9, 1.15}, {1.15, 1.1, 0.95}},    // around a corner
                                    {{0.4, 0.41, 1.3}, {0.43, 0.42, 1.05}}};  // down
    for (const Segment& way : ways) {
        const double coarse = slide(way.start, way.end, 500), fine = slide(way.start, way.end, 8000);
        EXPECT_GT(coarse, 0);
        EXPECT_LT(fine, coarse / 8) << way.start[0];  // 16 times shorter steps
    }
}

TEST(ToolContact, IsDefinedOnBadSurfaces) {
    const double not_a_number = std::nan("");
    Surface bad;
    bad.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0, 0}, {not_a_number, 0, 0}, {0.2, 0.2, 0}, {0.2, 0.2, 0}};
    bad.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 4, 1}, {5, 5, 5}, {5, 6, 5}, {0, 0, 1}};
    bad.update();
    const auto contacts = contacts_of(bad, SphereTool{0.1}, {{0.2, 0.2, 0.05}}, {{0.2, 0.2, 0.05}});
    ASSERT_EQ(contacts.size(), 1U);
    EXPECT_EQ(contacts[0].triangle, 0);
    // The centre exactly on the surface, and exactly on an edge of it.
    for (const Point& place : {Point{0.2, 0.2, 0}, Point{0.5, 0, 0}, Point{0, 0, 0}}) {
        for (const ToolContact& contact : contacts_of(bad, SphereTool{0.1}, {place})) {
            EXPECT_TRUE(is_finite(contact.normal) && std::isfinite(contact.depth) && std::isfinite(contact.share));
        }
    }
    EXPECT_NEAR(largest_depth(contacts_of(bad, SphereTool{0.1}, {{0.2, 0.2, 0}})), 0.1, 1e-15);
}

TEST(ToolContact, FarAwayIsTheSameToTheRoundingOfCoordinates) {
    Surface cube = unit_cube();
    const Pose pose{{0.9, 1.02, 0.31}};
    const CapsuleTool tool{{-0.1, 0, 0}, {0.3, 0.02, 0}, 0.05};
    const auto expected = contacts_of(cube, tool, pose);
    const Point shift{1e8, 1e8, -1e8};
    for (Point& position : cube.positions) position = add(position, shift);
    cube.update();
    const auto found = contacts_of(cube, tool, {add(pose.position, shift)});
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].triangle, expected[i].triangle);
        EXPECT_NEAR(found[i].depth, expected[i].depth, 1e-7);
        EXPECT_LT(length(subtract(found[i].normal, expected[i].normal)), 1e-5);
    }
}

}  // namespace
}  // namespace lancet::runtime
