// The energy safeguard on motions that a single linearisation does not survive.
#include <array>
#include <cmath>
#include <limits>

#include "tests/runtime/solve/bodies_under_test.hpp"
#include <gtest/gtest.h>

namespace lancet::test {
namespace {

constexpr std::array<int, 3> cells{6, 2, 2};

/// Energies are sums of positive terms in the scalar of the forces, and positions move by rounded velocities.
double rounding(runtime::ScalarMode scalar) {
    return 256 * epsilon_of(scalar);
}

class Safeguard : public ::testing::TestWithParam<runtime::ScalarMode> {
  protected:
    ReferenceSolid solid = jittered_bar(cells, 0.1, 0.1, 91);
    std::unique_ptr<runtime::Scheduler> scheduler = serial();

    std::unique_ptr<runtime::DeformableBody> body(bool safeguard = true) {
        runtime::Settings settings;  // 10 iterations of conjugate gradients with the coarse space, 40 ms
        settings.scalar = GetParam();
        settings.energy_safeguard = safeguard;
        return make_body(scene_of(solid), settings, *scheduler);
    }
};
INSTANTIATE_TEST_SUITE_P(Scalars, Safeguard, ::testing::ValuesIn(all_scalars),
                         [](const auto& instance) { return std::string(to_string(instance.param)); });

void expect_no_gain(runtime::DeformableBody& body, runtime::Scheduler& scheduler, int steps) {
    double energy = body.energies(scheduler).total();
    const double start = energy;
    for (int step = 0; step < steps; ++step) {
        const runtime::StepReport report = body.step(scheduler);
        EXPECT_FALSE(report.lost);
        const double now = body.energies(scheduler).total();
        ASSERT_TRUE(std::isfinite(now));
        EXPECT_LE(now, energy + rounding(body.settings().scalar) * start) << "step " << step;
        energy = now;
    }
    EXPECT_TRUE(positions_of(body).allFinite());
    EXPECT_EQ(body.totals().steps, steps);
    EXPECT_EQ(body.totals().lost, 0);
}

TEST_P(Safeguard, SpinningBodiesGainNoEnergy) {
    for (const double angle : {0.1, 1.0, 4.0}) {
        SCOPED_TRACE(angle);
        const auto b = body();
        const Eigen::Vector3d spin = angle / b->settings().time_step * Eigen::Vector3d(0.2, 0.3, 1).normalized();
        Eigen::VectorXd velocity(solid.unknowns());
        Eigen::Vector3d centre(0.3, 0.1, 0.1);
        for (Eigen::Index i = 0; i < velocity.size(); i += 3) {
            velocity.segment<3>(i) = spin.cross(solid.rest().segment<3>(i) - centre);
        }
        b->set_velocities(as_points(velocity));
        expect_no_gain(*b, *scheduler, 30);
    }
}

TEST_P(Safeguard, RandomVelocitiesGainNoEnergy) {
    for (const double speed : {1.0, 5.0, 20.0}) {
        SCOPED_TRACE(speed);
        const auto b = body();
        b->set_velocities(as_points(random_vector(solid.unknowns(), speed, 92)));
        expect_no_gain(*b, *scheduler, 30);
    }
}

TEST_P(Safeguard, IsWhatKeepsRandomVelocitiesInBounds) {
    // Without it the same motion gains: the tests above have something to find.
    const auto b = body(false);
    b->set_velocities(as_points(random_vector(solid.unknowns(), 5, 92)));
    const double start = b->energies(*scheduler).total();
    double largest = 0;
    for (int step = 0; step < 10; ++step) {
        b->step(*scheduler);
        const double energy = b->energies(*scheduler).total();
        largest = std::isfinite(energy) ? std::max(largest, energy) : HUGE_VAL;
    }
    EXPECT_GT(largest, 2 * start);
    const auto guarded = body(true);
    guarded->set_velocities(as_points(random_vector(solid.unknowns(), 5, 92)));
    for (int step = 0; step < 10; ++step) guarded->step(*scheduler);
    EXPECT_GT(guarded->totals().repeats, 0);
}

TEST_P(Safeguard, ASuddenGrabAddsNoMoreThanItsWork) {
    for (const double distance : {0.05, 0.5, 2.0}) {
        SCOPED_TRACE(distance);
        const auto b = body();
        const std::int32_t grabbed = 6;
        const Point& rest = solid.nodes[grabbed];
        b->hold(grabbed, {rest[0] + 0.6 * distance, rest[1] + 0.8 * distance, rest[2]});
        Eigen::VectorXd x = positions_of(*b), v = velocities_of(*b);
        double energy = b->energies(*scheduler).total();
        for (int step = 0; step < 20; ++step) {
            const runtime::StepReport report = b->step(*scheduler);
            EXPECT_FALSE(report.lost);
            const Eigen::VectorXd end_x = positions_of(*b), end_v = velocities_of(*b);
            const double now = b->energies(*scheduler).total();
            // What the hand does: the force that the node's motion needs beyond that of the elements.
            const Eigen::Vector3d elastic = elastic_forces_of(*b, *scheduler).segment<3>(3 * grabbed);
            const Eigen::Vector3d gained = end_v.segment<3>(3 * grabbed) - v.segment<3>(3 * grabbed);
            const Eigen::Vector3d hand = b->nodal_mass(grabbed) * gained / b->settings().time_step - elastic;
            const double work = hand.dot(end_x.segment<3>(3 * grabbed) - x.segment<3>(3 * grabbed));
            ASSERT_TRUE(std::isfinite(now));
            EXPECT_LE(now, energy + work + rounding(GetParam()) * (energy + std::abs(work))) << "step " << step;
            energy = now;
            x = end_x;
            v = end_v;
        }
        b->release_all();
        const double released = b->energies(*scheduler).total();
        for (int step = 0; step < 20; ++step) b->step(*scheduler);
        EXPECT_LE(b->energies(*scheduler).total(), released * (1 + rounding(GetParam())));
    }
}

TEST_P(Safeguard, StatesBeyondTheScalarAreReportedAndLeftFinite) {
    for (const double speed : {1e10, 1e30, 1e100, 1e200}) {
        SCOPED_TRACE(speed);
        const auto b = body();
        b->set_velocities(as_points(random_vector(solid.unknowns(), speed, 93)));
        const Eigen::VectorXd x = positions_of(*b);
        const double before = b->energies(*scheduler).total();
        const runtime::StepReport report = b->step(*scheduler);
        if (!std::isfinite(before)) {
            EXPECT_TRUE(report.lost || report.repeated) << "energies beyond double are reported";
        } else {
            EXPECT_LE(b->energies(*scheduler).total(), before * (1 + rounding(GetParam())));
        }
        EXPECT_EQ(b->totals().lost, report.lost ? 1 : 0);
        EXPECT_TRUE(positions_of(*b).allFinite());
        EXPECT_TRUE(velocities_of(*b).allFinite());
        if (report.lost) {
            EXPECT_EQ(positions_of(*b), x);
            EXPECT_EQ(velocities_of(*b), Eigen::VectorXd::Zero(x.size()));
        }
        // It goes on from there.
        for (int step = 0; step < 20; ++step) b->step(*scheduler);
        EXPECT_TRUE(positions_of(*b).allFinite());
        EXPECT_TRUE(std::isfinite(b->energies(*scheduler).total()));
    }
}

// Its kinetic energy is less than that of strains that rounding makes, so that it seems to gain some. It keeps its
// momentum all the same, up to rounding of a hundred steps.
TEST_P(Safeguard, LeavesABodyAloneThatDriftsSlowly) {
    for (const double speed : {1e-2, 1e-4, 1e-6}) {
        SCOPED_TRACE(speed);
        runtime::Scene scene = scene_of(solid);
        scene.fixed_nodes.clear();
        scene.gravity = {0, 0, 0};
        runtime::Settings settings;
        settings.scalar = GetParam();
        const auto b = make_body(scene, settings, *scheduler);
        b->set_velocities(std::vector<mesh::Point>(b->nodes(), mesh::Point{speed, -speed, 0.3 * speed}));
        for (int step = 0; step < 100; ++step) b->step(*scheduler);
        std::vector<mesh::Point> velocities(b->nodes());
        b->velocities(velocities);
        double momentum = 0, mass = 0;
        for (std::size_t node = 0; node < velocities.size(); ++node) {
            momentum += b->nodal_mass(static_cast<std::int32_t>(node)) * velocities[node][0];
            mass += b->nodal_mass(static_cast<std::int32_t>(node));
        }
        EXPECT_NEAR(momentum, mass * speed, 1e-3 * mass * speed);
    }
}

}  // namespace
}  // namespace lancet::test
