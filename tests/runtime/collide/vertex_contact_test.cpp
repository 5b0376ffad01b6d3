// Vertices in tetrahedra, with consistent depths and normals.
#include "lancet/runtime/collide/vertex_contact.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/runtime/collide/contact_meshes.hpp"
#include "tests/runtime/schedule/schedulers_under_test.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/mesh/cut/part_geometry.hpp"
#include "lancet/runtime/collide/vector3.hpp"

namespace lancet::runtime {
namespace {

using testing::collidable;

class VertexContacts : public ::testing::Test {
  protected:
    std::vector<VertexContact> find(const CollidableBody& first, const CollidableBody& second) {
        std::vector<VertexContact> contacts{{}};
        finder_.find(*serial_, first, second, contacts);
        return contacts;
    }

    std::unique_ptr<Scheduler> serial_ = make_scheduler(SchedulerKind::serial, 1);
    VertexContactFinder finder_;
};

mesh::TetMesh lower_block() {
    return mesh::box({.cells = {6, 6, 6}, .size = {1, 1, 1}});
}

TEST_F(VertexContacts, InAFlatSurfaceAreAsDeepAsTheyLie) {
    const CollidableBody lower = collidable(lower_block());
    // Deeper than two layers of its own nodes: the depth of the inner ones is propagated.
    for (const double depth : {0.003, 0.02, 0.23, 0.45}) {
        for (const Point& shift : {Point{0.21, 0.233, 0}, Point{1.0 / 6, 1.0 / 3, 0}}) {  // beside nodes, and on them
            const mesh::TetMesh mesh =
                mesh::box({.cells = {3, 3, 5}, .size = {0.5, 0.5, 0.6}, .origin = {shift[0], shift[1], 1 - depth}});
            const CollidableBody upper = collidable(mesh);
            const auto contacts = find(upper, lower);
            const auto below = std::ranges::count_if(mesh.nodes(), [](const Point& p) { return p[2] < 1 - 1e-12; });
            EXPECT_EQ(contacts.size(), static_cast<std::size_t>(below)) << depth;
            EXPECT_EQ(finder_.unresolved(), 0U);
            EXPECT_TRUE(std::ranges::is_sorted(contacts, {}, &VertexContact::vertex));
            for (const VertexContact& contact : contacts) {
                const Point& place = mesh.nodes()[contact.vertex];
                EXPECT_NEAR(contact.depth, 1 - place[2], 1e-13);
                EXPECT_NEAR(contact.normal[2], 1, 1e-14);
                Point weighted{};
                for (std::size_t corner = 0; corner < 4; ++corner) {
                    EXPECT_GT(contact.weights[corner], -1e-9);
                    const std::int32_t node = lower.tetrahedra()[contact.tetrahedron][corner];
                    weighted = add_scaled(weighted, contact.weights[corner], lower.positions()[node]);
                }
                EXPECT_LT(length(subtract(weighted, place)), 1e-14);
            }
        }
    }
}

TEST_F(VertexContacts, AreNoneWhereBodiesTouchOrAreApart) {
    const CollidableBody lower = collidable(lower_block());
    for (const double z : {1.0, 1.0 + 1e-9, 1.5}) {
        const CollidableBody upper =
            collidable(mesh::box({.cells = {3, 3, 3}, .size = {0.5, 0.5, 0.5}, .origin = {0.25, 0.25, z}}));
        EXPECT_TRUE(find(upper, lower).empty()) << z;
        EXPECT_TRUE(find(lower, upper).empty()) << z;
        EXPECT_EQ(finder_.unresolved(), 0U) << z;
    }
    EXPECT_TRUE(find(lower, lower).empty());
}

TEST_F(VertexContacts, InABallPointAlongItsRadii) {
    // A cube of nodes mapped to a ball of radius 1: faces are flat, so depths are those of the ball to the square of
    // the length of its edges over 8 (the sagitta), 0.3^2 / 8.
    constexpr double sagitta = 0.012;
    mesh::TetMesh::Definition ball =
        mesh::box({.cells = {8, 8, 8}, .size = {2, 2, 2}, .origin = {-1, -1, -1}}).definition();
    for (Point& p : ball.nodes) {
        const double largest = std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
        if (largest > 0) p = scale(p, largest / length(p));
    }
    const CollidableBody second = collidable(mesh::TetMesh(ball));
    mesh::TetMesh::Definition small =
        mesh::box({.cells = {4, 4, 4}, .size = {0.4, 0.4, 0.4}, .origin = {-0.2, -0.2, 0.8}}).definition();
    const CollidableBody first = collidable(mesh::TetMesh(small));
    const auto contacts = find(first, second);
    EXPECT_GT(contacts.size(), 40U);
    EXPECT_EQ(finder_.unresolved(), 0U);
    for (const VertexContact& contact : contacts) {
        const Point& place = small.nodes[contact.vertex];
        // Up to 0.2 deep and 0.28 beside the axis: a radius there is at most 0.3 rad off the mean of the surface's
        // normals around, which are its own to half the angle of an edge.
        EXPECT_NEAR(contact.depth, 1 - length(place), sagitta + 0.01);
        EXPECT_GT(dot(contact.normal, direction(place)), std::cos(0.3));
    }
}

TEST_F(VertexContacts, OfABodyWhollyInsideAreCounted) {
    const CollidableBody outer = collidable(lower_block());
    const CollidableBody inner =
        collidable(mesh::box({.cells = {2, 2, 2}, .size = {0.1, 0.1, 0.1}, .origin = {0.36, 0.37, 0.38}}));
    EXPECT_TRUE(find(inner, outer).empty());
    EXPECT_EQ(finder_.unresolved(), 27U);
    EXPECT_TRUE(find(outer, inner).empty());
}

/// A bar along x, its half beyond x = 1 folded back over the first at a height.
std::vector<Point> folded(const mesh::TetMesh& bar, double height) {
    std::vector<Point> positions(bar.nodes().begin(), bar.nodes().end());
    // Turned by 180 degrees about the line x = 1, z = (0.2 + height) / 2, except for a bend.
    for (Point& p : positions) {
        const double angle = std::clamp((p[0] - 0.8) / 0.4, 0.0, 1.0) * 3.14159265358979323846;
        const double radius = 0.2 + height / 2 - p[2], along = std::min(p[0], 0.8) - std::max(p[0] - 1.2, 0.0);
        p = {angle > 3.14 ? 0.8 - std::max(p[0] - 1.2, 0.0) : along + radius * std::sin(angle), p[1],
             0.2 + height / 2 - radius * std::cos(angle)};
    }
    return positions;
}

TEST_F(VertexContacts, OfABodyFoldedOntoItselfAreThoseOfItsTwoHalves) {
    const mesh::TetMesh bar = mesh::box({.cells = {20, 6, 4}, .size = {2, 0.2, 0.2}});
    CollidableBody body = collidable(bar);
    body.update(folded(bar, 0.08));
    EXPECT_TRUE(find(body, body).empty()) << "apart";
    EXPECT_EQ(finder_.unresolved(), 0U);
    // Pressed on each other by 0.03; shifted, so that nodes are not on each other's faces.
    std::vector<Point> positions = folded(bar, -0.03);
    for (std::size_t node = 0; node < positions.size(); ++node) {
        if (bar.nodes()[node][0] > 1.3) {
            positions[node][0] += 0.013;
            positions[node][1] += 0.007;
        }
    }
    body.update(positions);
    const auto contacts = find(body, body);
    int up = 0, down = 0;
    for (const VertexContact& contact : contacts) {
        const Point& rest = bar.nodes()[contact.vertex];
        // Away from the rim, where edges also lead in through the sides.
        if (rest[0] > 0.15 && rest[0] < 0.6 && rest[2] > 0.19 && std::abs(rest[1] - 0.1) < 0.04) {
            // The top of the lower half goes down, out of the upper half.
            EXPECT_NEAR(contact.depth, 0.03, 1e-12);
            EXPECT_NEAR(contact.normal[2], -1, 1e-12);
            ++down;
        }
        if (rest[0] > 1.4 && rest[0] < 1.85 && rest[2] > 0.19 && std::abs(rest[1] - 0.1) < 0.04) {
            EXPECT_NEAR(contact.depth, 0.03, 1e-12);
            EXPECT_NEAR(contact.normal[2], 1, 1e-12);
            ++up;
        }
    }
    EXPECT_EQ(down, 4 * 3);
    EXPECT_EQ(up, 4 * 3);
}

/// A block that is cut in two along element faces at z = 1/2, as copies of the nodes there.
mesh::TetMesh::Definition cut_block() {
    mesh::TetMesh::Definition block = mesh::box({.cells = {6, 6, 4}, .split = mesh::Split::six}).definition();
    std::vector<std::int32_t> copy(block.nodes.size(), -1);
    for (mesh::Tetrahedron& element : block.tetrahedra) {
        double middle = 0;
        for (const std::int32_t node : element) middle += block.nodes[node][2] / 4;
        if (middle < 0.5) continue;
        for (std::int32_t& node : element) {
            if (block.nodes[node][2] != 0.5) continue;
            if (copy[node] < 0) {
                copy[node] = static_cast<std::int32_t>(block.nodes.size());
                block.nodes.push_back(block.nodes[node]);
            }
            node = copy[node];
        }
    }
    block.node_sets.clear();
    return block;
}

TEST_F(VertexContacts, OfTheWallsOfACutAppearWhenTheyArePressed) {
    const mesh::TetMesh mesh(cut_block());
    CollidableBody body = collidable(mesh);
    EXPECT_TRUE(find(body, body).empty()) << "closed, at rest";
    std::vector<Point> positions(mesh.nodes().begin(), mesh.nodes().end());
    const auto upper = [&](const mesh::Tetrahedron& element) {
        double middle = 0;
        for (const std::int32_t node : element) middle += mesh.nodes()[node][2] / 4;
        return middle > 0.5;
    };
    std::vector<bool> is_upper(mesh.nodes().size());
    for (const mesh::Tetrahedron& element : mesh.tetrahedra()) {
        for (const std::int32_t node : element) is_upper[node] = upper(element);
    }
    for (std::size_t node = 0; node < positions.size(); ++node) {
        if (is_upper[node]) positions[node] = add(positions[node], {0.031, 0.017, -0.04});
    }
    body.update(positions);
    int walls = 0;
    for (const VertexContact& contact : find(body, body)) {
        const Point& rest = mesh.nodes()[contact.vertex];
        // Away from the rim, where edges also lead out through the sides.
        if (std::abs(rest[0] - 0.5) > 0.2 || std::abs(rest[1] - 0.5) > 0.2) continue;
        ++walls;
        EXPECT_NEAR(rest[2], 0.5, 1e-15);
        EXPECT_NEAR(contact.depth, 0.04, 1e-13);
        EXPECT_NEAR(contact.normal[2], is_upper[contact.vertex] ? 1 : -1, 1e-13);
    }
    EXPECT_EQ(walls, 2 * 9);
}

/// The same with a cut that runs through elements: what collides are the parts, with the walls of the cut.
TEST_F(VertexContacts, OfTheWallsOfACutThroughElementsAppearWhenTheyArePressed) {
    mesh::CutMesh cut(mesh::box({.cells = {6, 6, 4}}));
    cut.cut(mesh::CutSurface::plane({0, 0, 0.43}, {0, 0, 1}));
    const mesh::PartGeometry parts = mesh::part_geometry(cut);
    std::vector<Point> positions = mesh::place(parts, cut, cut.rest_positions());
    const std::vector<Point> rest = positions;
    CollidableBody body(positions.size(), parts.tetrahedra, parts.triangles);
    body.update(positions);
    EXPECT_TRUE(find(body, body).empty()) << "closed, at rest";
    EXPECT_EQ(finder_.unresolved(), 0U);
    std::vector<bool> is_upper(positions.size());
    for (const mesh::Tetrahedron& element : parts.tetrahedra) {
        double middle = 0;
        for (const std::int32_t node : element) middle += rest[node][2] / 4;
        for (const std::int32_t node : element) is_upper[node] = middle > 0.43;
    }
    for (std::size_t node = 0; node < positions.size(); ++node) {
        if (is_upper[node]) positions[node] = add(positions[node], {0.031, 0.017, -0.04});
    }
    body.update(positions);
    int walls = 0;
    for (const VertexContact& contact : find(body, body)) {
        const Point& place = rest[contact.vertex];
        // Away from the rim, where edges also lead out through the sides.
        if (std::abs(place[0] - 0.5) > 0.2 || std::abs(place[1] - 0.5) > 0.2) continue;
        ++walls;
        // The corners of parts beside the wall are pressed in as well.
        const double from_wall = std::abs(place[2] - 0.43);
        EXPECT_NEAR(contact.depth, 0.04 - from_wall, 1e-12);
        EXPECT_NEAR(contact.normal[2], is_upper[contact.vertex] ? 1 : -1, 1e-12);
    }
    EXPECT_GT(walls, 2 * 9);
}

TEST_F(VertexContacts, AreTheSameByEveryBroadPhaseAndScheduler) {
    const mesh::TetMesh below = lower_block();
    const mesh::TetMesh above = mesh::box({.cells = {7, 6, 5}, .size = {0.8, 0.7, 0.5}, .origin = {0.11, 0.13, 0.87}});
    const auto expected = find(collidable(above), collidable(below));
    ASSERT_GT(expected.size(), 20U);
    const auto expect_same = [&](const std::vector<VertexContact>& found) {
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_EQ(found[i].vertex, expected[i].vertex);
            EXPECT_EQ(found[i].tetrahedron, expected[i].tetrahedron);
            EXPECT_EQ(found[i].depth, expected[i].depth);
            EXPECT_EQ(found[i].normal, expected[i].normal);
        }
    };
    for (const BroadPhaseKind kind : broad_phase_kinds())
        expect_same(find(collidable(above, kind), collidable(below, kind)));
    for (const testing::SchedulerChoice& choice : testing::schedulers_under_test()) {
        std::vector<VertexContact> found;
        finder_.find(*choice.make(), collidable(above), collidable(below), found);
        expect_same(found);
    }
}

TEST_F(VertexContacts, AreDefinedForLostAndCollapsedBodies) {
    const CollidableBody lower = collidable(lower_block());
    const mesh::TetMesh mesh = mesh::box({.cells = {3, 3, 3}, .size = {0.5, 0.5, 0.5}, .origin = {0.21, 0.23, 0.9}});
    CollidableBody upper = collidable(mesh);
    std::vector<Point> positions(mesh.nodes().begin(), mesh.nodes().end());
    positions[5][1] = std::nan("");
    positions[9][0] = HUGE_VAL;
    upper.update(positions);
    for (const VertexContact& contact : find(upper, lower)) {
        EXPECT_TRUE(contact.vertex != 5 && contact.vertex != 9);
        EXPECT_TRUE(std::isfinite(contact.depth) && is_finite(contact.normal));
    }
    for (const Point& shape : {Point{0, 0, 0}, Point{1, 1, 0}, Point{1, 1, -1}}) {  // a point, flat, mirrored
        for (std::size_t node = 0; node < positions.size(); ++node) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                positions[node][axis] = 0.5 + shape[axis] * (mesh.nodes()[node][axis] - 0.45) + (axis == 2 ? 0.4 : 0);
            }
        }
        upper.update(positions);
        for (const auto& contacts : {find(upper, lower), find(lower, upper), find(upper, upper)}) {
            for (const VertexContact& contact : contacts) {
                EXPECT_TRUE(std::isfinite(contact.depth) && is_finite(contact.normal));
            }
        }
    }
}

TEST(CollidableBodies, RefuseWhatDoesNotFit) {
    const std::vector<mesh::Tetrahedron> elements{{0, 1, 2, 3}}, bad{{0, 1, 2, 4}};
    const std::vector<mesh::Triangle> surface{{0, 1, 2}}, bad_surface{{0, -1, 2}};
    EXPECT_THROW(CollidableBody(4, bad, surface), Error);
    EXPECT_THROW(CollidableBody(4, elements, bad_surface), Error);
    CollidableBody body(4, elements, surface);
    try {
        body.update(std::vector<Point>(3));
        FAIL() << "expected an error";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), ::testing::HasSubstr("3 positions; expected 4"));
    }
}

}  // namespace
}  // namespace lancet::runtime
