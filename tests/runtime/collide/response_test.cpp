// Forces and holds from contacts: action and reaction, springs, dampers, and displacements that end a contact.
#include "lancet/runtime/collide/response.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "tests/runtime/collide/contact_meshes.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {
namespace {

using testing::collidable;
using testing::Surface;

Point force_of(const std::vector<Point>& forces) {
    Point sum{};
    for (const Point& force : forces) sum = add(sum, force);
    return sum;
}

Point moment_of(std::span<const Point> positions, const std::vector<Point>& forces, const Point& about = {}) {
    Point sum{};
    for (std::size_t i = 0; i < forces.size(); ++i) sum = add(sum, cross(subtract(positions[i], about), forces[i]));
    return sum;
}

/// What rounding makes of sums of some hundred products of sizes below 1 m with so much force: 100 units in the last
/// place, and ten times that for the cancellation in the weights.
double rounding_of(const std::vector<Point>& forces) {
    double sum = 0;
    for (const Point& force : forces) sum += length(force);
    return 1e3 * std::numeric_limits<double>::epsilon() * sum;
}

std::vector<Point> random_vectors(std::size_t count, double size, unsigned seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> component(-size, size);
    std::vector<Point> all(count);
    for (Point& vector : all) vector = {component(random), component(random), component(random)};
    return all;
}

class ToolResponse : public ::testing::Test {
  protected:
    void touch(const Point& place) {
        motion_.set(SphereTool{0.3}, {place});
        ToolContactFinder().find(*surface_.boxes, surface_.positions, surface_.triangles, motion_, contacts_);
    }

    Surface surface_ = testing::surface_of(mesh::box({.cells = {4, 4, 4}}));
    ToolMotion motion_;
    std::vector<ToolContact> contacts_;
};

TEST_F(ToolResponse, IsEqualAndOppositeOnToolAndSurface) {
    const std::vector<Point> velocities = random_vectors(surface_.positions.size(), 0.1, 1);
    for (const Point& place : {Point{0.4, 0.45, 1.2}, {1.1, 0.3, 1.15}, {0.9, 1.1, 1.12}, {0.6, 0.5, 0.9}}) {
        touch(place);
        ASSERT_FALSE(contacts_.empty());
        std::vector<Point> forces(surface_.positions.size());
        const RigidVelocity tool{{0.1, 0.2, -0.3}, {1, -2, 0.5}, {0.2, 0.1, 0.9}};
        const Wrench wrench = add_penalty_forces(contacts_, {100, 2}, surface_.triangles, velocities, tool, forces);
        EXPECT_GT(length(wrench.force), 0);
        EXPECT_LT(length(add(wrench.force, force_of(forces))), rounding_of(forces));
        EXPECT_LT(length(add(wrench.moment, moment_of(surface_.positions, forces, tool.about))), rounding_of(forces));
    }
}

TEST_F(ToolResponse, IsWhatSpringsAndDampersSay) {
    touch({0.4, 0.45, 1.2});
    const double k = 250;
    std::vector<Point> forces(surface_.positions.size());
    const Wrench spring = add_penalty_forces(contacts_, {k, 0}, surface_.triangles, {}, {}, forces);
    Point expected{};
    double deepest = 0;
    for (const ToolContact& contact : contacts_) {
        expected = add_scaled(expected, k * contact.share * contact.depth, contact.normal);
        deepest = std::max(deepest, contact.depth);
    }
    EXPECT_LT(length(subtract(spring.force, expected)), 1e-12 * length(expected));
    EXPECT_NEAR(deepest, 0.1, 1e-14);

    // Where the tool comes nearer the damper pushes more, where it leaves less, and never pulls.
    const std::vector<Point> resting(surface_.positions.size());
    const auto force_at = [&](double speed) {
        std::vector<Point> some(surface_.positions.size());
        return add_penalty_forces(contacts_, {k, 10}, surface_.triangles, resting, {{0, 0, speed}}, some).force[2];
    };
    EXPECT_GT(force_at(-0.1), spring.force[2] * (1 + 1e-3));
    EXPECT_LT(force_at(0.1), spring.force[2] * (1 - 1e-3));
    EXPECT_NEAR(force_at(0), spring.force[2], 1e-12);
    EXPECT_EQ(force_at(1e4), 0);
}

TEST_F(ToolResponse, SpringForcesAreTheGradientOfTheirEnergy) {
    // For one contact with the inside of a face: on the tool, the force is minus the derivative by its place.
    const Penalty penalty{100, 0};
    surface_.triangles = {{0, 1, 2}};
    surface_.positions = {{-5, -5, 0}, {5, -5, 0}, {0, 8, 0}};
    surface_.update();
    const auto energy_at = [&](double z) {
        touch({0.1, 0.2, z});
        return penalty_energy(contacts_, penalty);
    };
    const double h = 1e-4, derivative = (energy_at(0.2 + h) - energy_at(0.2 - h)) / (2 * h);
    touch({0.1, 0.2, 0.2});
    std::vector<Point> forces(3);
    const Wrench wrench = add_penalty_forces(contacts_, penalty, surface_.triangles, {}, {}, forces);
    // The energy is quadratic: the difference is exact but for rounding of energies near 0.5 J over 2 h.
    EXPECT_NEAR(wrench.force[2], -derivative, 1e-11);
    EXPECT_NEAR(wrench.force[2], 100 * 0.1, 1e-12);
}

TEST_F(ToolResponse, HoldsEndAContact) {
    surface_.triangles = {{0, 1, 2}};
    surface_.positions = {{-5, -5, 0}, {5, -5, 0}, {0, 8, 0}};
    surface_.update();
    touch({0.1, 0.2, 0.2});
    ASSERT_EQ(contacts_.size(), 1U);
    std::vector<ContactHold> holds;
    tool_holds(contacts_, surface_.triangles, surface_.positions, holds);
    ASSERT_EQ(holds.size(), 3U);
    double moved = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(holds[i].node, static_cast<std::int32_t>(i));
        EXPECT_EQ(holds[i].direction, (Point{0, 0, -1}));
        moved += contacts_[0].weights[i] * holds[i].target[2];
        surface_.positions[i] = holds[i].target;
    }
    EXPECT_NEAR(moved, -0.1, 1e-15);
    // A triangle that has turned a little is not farther from the sphere than before along the old normal.
    surface_.update();
    touch({0.1, 0.2, 0.2});
    for (const ToolContact& contact : contacts_) EXPECT_LT(contact.depth, 0.1 * 0.1);
}

TEST_F(ToolResponse, HoldsANodeOnceByWhatMovesItFarthest) {
    touch({0.4, 0.45, 1.1});
    ASSERT_GT(contacts_.size(), 2U);
    std::vector<ContactHold> holds;
    tool_holds(contacts_, surface_.triangles, surface_.positions, holds);
    for (std::size_t i = 0; i < holds.size(); ++i) {
        if (i > 0) {
            EXPECT_LT(holds[i - 1].node, holds[i].node);
        }
        const double distance = dot(subtract(holds[i].target, surface_.positions[holds[i].node]), holds[i].direction);
        double farthest = 0;
        for (const ToolContact& contact : contacts_) {
            double squares = 0;
            for (const double weight : contact.weights) squares += weight * weight;
            for (std::size_t corner = 0; corner < 3; ++corner) {
                if (surface_.triangles[contact.triangle][corner] != holds[i].node) continue;
                farthest = std::max(farthest, contact.depth * contact.weights[corner] / squares);
            }
        }
        EXPECT_NEAR(distance, farthest, 1e-14);
        EXPECT_NEAR(length(holds[i].direction), 1, 1e-14);
    }
}

TEST(VertexResponse, HasNeitherForceNorMoment) {
    const mesh::TetMesh below = mesh::box({.cells = {5, 5, 5}});
    const mesh::TetMesh above = mesh::box({.cells = {4, 3, 5}, .size = {0.7, 0.6, 0.5}, .origin = {0.5, 0.13, 0.83}});
    const auto serial = make_scheduler(SchedulerKind::serial, 1);
    std::vector<VertexContact> contacts;
    VertexContactFinder().find(*serial, collidable(above), collidable(below), contacts);
    ASSERT_GT(contacts.size(), 10U);
    std::vector<Point> on_above(above.nodes().size()), on_below(below.nodes().size());
    const auto above_velocities = random_vectors(on_above.size(), 0.1, 2),
               below_velocities = random_vectors(on_below.size(), 0.1, 3);
    add_penalty_forces(contacts, {300, 5}, below.tetrahedra(), above_velocities, below_velocities, on_above, on_below);
    EXPECT_GT(length(force_of(on_above)), 1);
    EXPECT_LT(length(add(force_of(on_above), force_of(on_below))), rounding_of(on_above));
    EXPECT_LT(length(add(moment_of(above.nodes(), on_above), moment_of(below.nodes(), on_below))),
              rounding_of(on_above));
}

TEST(VertexResponse, HoldsEndAContact) {
    const std::vector<mesh::Tetrahedron> elements{{0, 1, 2, 3}};
    std::vector<Point> second{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, first{{0.2, 0.3, 0.1}};
    const VertexContact contact{0, 0, {0.4, 0.2, 0.3, 0.1}, 0.1, {0, 0, -1}};
    std::vector<ContactHold> first_holds, second_holds;
    vertex_holds(std::span(&contact, 1), elements, first, second, first_holds, second_holds);
    ASSERT_EQ(first_holds.size(), 1U);
    ASSERT_EQ(second_holds.size(), 4U);
    double gone = contact.normal[2] * (first_holds[0].target[2] - first[0][2]);
    for (std::size_t corner = 0; corner < 4; ++corner) {
        gone -= contact.weights[corner] * contact.normal[2] * (second_holds[corner].target[2] - second[corner][2]);
    }
    EXPECT_NEAR(gone, contact.depth, 1e-15);
}

TEST(Penalty, RefusesWhatMakesNoSense) {
    EXPECT_NO_THROW(validate(Penalty{}));
    for (const Penalty& penalty : {Penalty{-1, 0}, Penalty{1, std::nan("")}, Penalty{HUGE_VAL, 0}}) {
        try {
            validate(penalty);
            FAIL() << "expected an error";
        } catch (const Error& error) {
            EXPECT_THAT(error.what(), ::testing::HasSubstr("expected 0 or more"));
        }
    }
}

}  // namespace
}  // namespace lancet::runtime
