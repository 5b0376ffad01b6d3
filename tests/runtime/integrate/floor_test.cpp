// A rigid floor: nothing passes it, it does not pull, and it adds no energy.
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/runtime/solve/bodies_under_test.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::test {
namespace {

using runtime::ElementModel;
using runtime::Integrator;

constexpr std::array<int, 3> cells{3, 2, 2};

/// A block above a tilted floor, with gravity along the floor's normal.
struct Block {
    ReferenceSolid solid = jittered_bar(cells, 0.1, 0.1, 221);
    Eigen::Vector3d normal = Eigen::Vector3d(1, 2, 2) / 3;
    runtime::Scene scene = scene_of(solid);
    double lowest = HUGE_VAL;

    explicit Block(double height) {
        for (const Point& node : solid.nodes) lowest = std::min(lowest, normal.dot(Eigen::Vector3d(node.data())));
        const Eigen::Vector3d point = (lowest - height) * normal;
        scene.floor = runtime::Floor{{point[0], point[1], point[2]}, {normal[0], normal[1], normal[2]}};
        const Eigen::Vector3d gravity = -9.81 * normal;
        scene.gravity = {gravity[0], gravity[1], gravity[2]};
        lowest -= height;
    }
    double lowest_above_floor(const Eigen::VectorXd& x) const {
        double height = HUGE_VAL;
        for (Eigen::Index i = 0; i < x.size(); i += 3) {
            height = std::min(height, normal.dot(Eigen::Vector3d(x.segment<3>(i))) - lowest);
        }
        return height;
    }
};

runtime::Settings settings_of(Integrator integrator, double time_step) {
    runtime::Settings settings = accurate_settings();
    settings.integrator = integrator;
    settings.time_step = time_step;
    settings.energy_safeguard = integrator == Integrator::implicit_euler;
    return settings;
}

TEST(Floor, StopsAFallingBodyAndAddsNoEnergy) {
    for (const auto scalar : all_scalars) {
        for (const double time_step : {0.002, 0.01, 0.04}) {
            SCOPED_TRACE(::testing::Message() << to_string(scalar) << ", " << time_step);
            const Block block(0.2);
            const auto scheduler = serial();
            runtime::Settings settings = settings_of(Integrator::implicit_euler, time_step);
            settings.scalar = scalar;
            settings.conjugate_gradients = {.iterations = 100, .tolerance = 1e-6};
            const auto body = make_body(block.scene, settings, *scheduler);
            const double start = body->energies(*scheduler).total();
            double energy = start, deepest = 0, largest = 0;
            const int steps = static_cast<int>(std::lround(1.2 / time_step));
            for (int step = 0; step < steps; ++step) {
                body->step(*scheduler);
                const runtime::Energies now = body->energies(*scheduler);
                largest = std::max(largest, now.kinetic);
                // Energies are of the size of the fall; rounding is that of elastic energies in the scalar.
                EXPECT_LE(now.total(), energy + 1e3 * epsilon_of(scalar) * largest) << "step " << step;
                energy = now.total();
                deepest = std::max(deepest, -block.lowest_above_floor(positions_of(*body)));
            }
            // Heights are sums of coordinates below half a metre, and held directions are filtered in the scalar.
            EXPECT_LE(deepest, 1e-12 + 16 * 0.5 * epsilon_of(scalar));
            EXPECT_LT(body->energies(*scheduler).kinetic, 0.3 * largest) << "it has come to lie";
            EXPECT_GT(largest, 0) << "it fell";
        }
    }
}

TEST(Floor, CarriesTheWeightOfABodyAtRest) {
    Block block(0);
    block.scene.rayleigh_mass = 10;
    const auto scheduler = serial();
    const auto body = make_body(block.scene, settings_of(Integrator::implicit_euler, 0.01), *scheduler);
    for (int step = 0; step < 2000; ++step) body->step(*scheduler);
    // On the face that has come to lie: elastic forces of the nodes off the floor balance their weight.
    const Eigen::VectorXd x = positions_of(*body), force = elastic_forces_of(*body, *scheduler);
    double carried = 0, weight = 0;
    for (Eigen::Index node = 0; node < x.size() / 3; ++node) {
        const double own = 9.81 * body->nodal_mass(static_cast<std::int32_t>(node));
        weight += own;
        const double above = block.normal.dot(Eigen::Vector3d(x.segment<3>(3 * node))) - block.lowest;
        if (above < 0.005) carried += own - block.normal.dot(Eigen::Vector3d(force.segment<3>(3 * node)));
    }
    EXPECT_NEAR(carried, weight, 1e-3 * weight);
    EXPECT_GE(block.lowest_above_floor(x), -1e-3);
    EXPECT_LT(velocities_of(*body).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(Floor, DoesNotPull) {
    const Block block(0);
    const auto scheduler = serial();
    const auto body = make_body(block.scene, settings_of(Integrator::implicit_euler, 0.01), *scheduler);
    for (int step = 0; step < 50; ++step) body->step(*scheduler);
    // Lifted by twice its weight, it goes as if there were no floor.
    std::vector<Point> lift(body->nodes());
    for (std::size_t node = 0; node < lift.size(); ++node) {
        const double own = body->nodal_mass(static_cast<std::int32_t>(node));
        for (std::size_t axis = 0; axis < 3; ++axis) lift[node][axis] = -2 * own * block.scene.gravity[axis];
    }
    body->set_loads(lift);
    for (int step = 0; step < 40; ++step) body->step(*scheduler);
    EXPECT_GT(block.lowest_above_floor(positions_of(*body)), 0.3) << "it rises by g t^2 / 2 = 0.8 m";
}

TEST(Floor, HoldsForEveryIntegrator) {
    for (const Integrator integrator : {Integrator::implicit_midpoint, Integrator::newmark,
                                        Integrator::symplectic_euler, Integrator::central_differences}) {
        SCOPED_TRACE(to_string(integrator));
        Block block(0.05);
        block.scene.rayleigh_mass = 5;
        const auto scheduler = serial();
        const double time_step = 5e-4;
        const auto body = make_body(block.scene, settings_of(integrator, time_step), *scheduler);
        const double start = body->energies(*scheduler).total();
        double weight = 0;
        for (std::size_t node = 0; node < body->nodes(); ++node) {
            weight += 9.81 * body->nodal_mass(static_cast<std::int32_t>(node));
        }
        for (int step = 0; step < 1000; ++step) {
            body->step(*scheduler);
            EXPECT_LE(body->energies(*scheduler).total(), start + 1e-3 * weight * 0.05) << "step " << step;
            EXPECT_GE(block.lowest_above_floor(positions_of(*body)), -1e-11) << "step " << step;
        }
        EXPECT_LT(body->energies(*scheduler).gravity, -0.5 * weight * 0.05) << "it fell";
    }
}

TEST(Floor, GoesOnFromASavedStateToTheBit) {
    const Block block(0.02);
    const auto scheduler = serial();
    for (const Integrator integrator : {Integrator::implicit_euler, Integrator::central_differences}) {
        const auto settings = settings_of(integrator, 5e-4);
        const auto a = make_body(block.scene, settings, *scheduler);
        for (int step = 0; step < 150; ++step) a->step(*scheduler);
        const runtime::BodyState state = a->save();
        for (int step = 0; step < 50; ++step) a->step(*scheduler);
        const auto b = make_body(block.scene, settings, *scheduler);
        b->restore(*scheduler, state);
        for (int step = 0; step < 50; ++step) b->step(*scheduler);
        EXPECT_EQ(positions_of(*a), positions_of(*b));
        EXPECT_EQ(velocities_of(*a), velocities_of(*b));
    }
}

TEST(Floor, ThatMakesNoSenseIsRefused) {
    const auto scheduler = serial();
    const auto refused = [&](const Block& block, const std::string& text) {
        try {
            make_body(block.scene, settings_of(Integrator::implicit_euler, 0.01), *scheduler);
            ADD_FAILURE() << "no error that says '" << text << "'";
        } catch (const Error& error) {
            EXPECT_THAT(error.what(), ::testing::HasSubstr(text));
        }
    };
    refused(Block(-0.01), "below the floor");
    Block block(0.1);
    block.scene.floor->normal = {1, 1, 0};
    refused(block, "length");
    block = Block(0.1);
    block.scene.floor->point[1] = std::nan("");
    refused(block, "not finite");
}

}  // namespace
}  // namespace lancet::test
