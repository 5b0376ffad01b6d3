// Momentum of free bodies, and free fall. No damping: stiffness damping resists the rigid rotation of a strained body.
#include <array>
#include <cmath>

#include "tests/runtime/solve/bodies_under_test.hpp"
#include <gtest/gtest.h>

namespace lancet::test {
namespace {

constexpr std::array<int, 3> cells{5, 3, 2};

Eigen::VectorXd nodal_masses(const runtime::DeformableBody& body) {
    Eigen::VectorXd mass(3 * static_cast<Eigen::Index>(body.nodes()));
    for (std::size_t node = 0; node < body.nodes(); ++node) {
        mass.segment<3>(3 * static_cast<Eigen::Index>(node))
            .setConstant(body.nodal_mass(static_cast<std::int32_t>(node)));
    }
    return mass;
}

struct FreeBody {
    ReferenceSolid solid = jittered_bar(cells, 0.1, 0.15, 81);
    std::unique_ptr<runtime::Scheduler> scheduler = serial();
    std::unique_ptr<runtime::DeformableBody> body;
    Eigen::VectorXd mass;

    explicit FreeBody(const runtime::Settings& settings, std::array<double, 3> gravity = {0, 0, 0}) {
        runtime::Scene scene = scene_of(solid);
        scene.gravity = gravity;
        body = make_body(scene, settings, *scheduler);
        mass = nodal_masses(*body);
    }
    void set_random_motion() {
        body->set_positions(as_points(solid.rest() + random_vector(solid.unknowns(), 0.01, 82)));
        body->set_velocities(as_points(random_vector(solid.unknowns(), 1, 83)));
    }
    Eigen::VectorXd momenta() const { return mass.cwiseProduct(velocities_of(*body)); }
};

class Conservation : public ArithmeticTest {};
INSTANTIATE_TEST_SUITE_P(Arithmetics, Conservation, ::testing::ValuesIn(compiled_arithmetics()), ArithmeticName());

TEST_P(Conservation, OfLinearMomentum) {
    runtime::Settings settings = accurate_settings();
    GetParam().set(settings);
    settings.time_step = 0.02;
    const bool is_double = GetParam().scalar == runtime::ScalarMode::double_precision;
    settings.conjugate_gradients = {.iterations = 300, .tolerance = is_double ? 1e-13 : 1e-6};
    for (const bool safeguard : {false, true}) {
        settings.energy_safeguard = safeguard;
        FreeBody free(settings);
        free.set_random_motion();
        const Eigen::Vector3d start = total_force(free.momenta());
        const double size = free.momenta().cwiseAbs().sum();
        for (int step = 0; step < 20; ++step) {
            free.body->step(*free.scheduler);
            // The solver's tolerance is reached within the condition of the preconditioned system, below 1e2.
            EXPECT_LE((total_force(free.momenta()) - start).norm(), (step + 1) * (is_double ? 1e-11 : 1e-4) * size);
        }
    }
}

TEST(FreeFall, InTheDefaultSettingsStoresNoEnergyWorthNaming) {
    FreeBody free({}, {0, -9.81, 0});
    for (int step = 0; step < 25; ++step) free.body->step(*free.scheduler);
    const runtime::Energies energies = free.body->energies(*free.scheduler);
    // What ten iterations leave, squared.
    EXPECT_LT(energies.elastic, 1e-9 * energies.kinetic);
}

TEST(Momentum, ElasticImpulsesHaveNoMoment) {
    runtime::Settings settings = accurate_settings(1e-13);
    settings.time_step = 0.02;
    settings.newton_iterations = 100;
    settings.newton_tolerance = 1e-12;
    settings.energy_safeguard = false;
    FreeBody free(settings);
    free.set_random_motion();
    for (int step = 0; step < 20; ++step) {
        const Eigen::VectorXd before = free.momenta();
        const runtime::StepReport report = free.body->step(*free.scheduler);
        EXPECT_LT(report.newton_iterations, 100);
        const Eigen::VectorXd impulse = free.momenta() - before, x = positions_of(*free.body);
        const double size = impulse.cwiseAbs().sum() * x.cwiseAbs().maxCoeff();
        EXPECT_LE(total_torque(x, impulse).norm(), 1e-9 * size);
    }
}

TEST(Momentum, IsConservedByTheMidpointRule) {
    runtime::Settings settings = accurate_settings(1e-13);
    settings.time_step = 0.01;
    settings.integrator = runtime::Integrator::implicit_midpoint;
    settings.newton_iterations = 100;
    settings.newton_tolerance = 1e-12;
    settings.energy_safeguard = false;
    FreeBody free(settings);
    free.set_random_motion();
    const Eigen::Vector3d start = total_torque(positions_of(*free.body), free.momenta());
    const Eigen::Vector3d momentum = total_force(free.momenta());
    for (int step = 0; step < 20; ++step) {
        free.body->step(*free.scheduler);
        const Eigen::VectorXd x = positions_of(*free.body), p = free.momenta();
        const double size = p.cwiseAbs().sum() * x.cwiseAbs().maxCoeff();
        EXPECT_LE((total_torque(x, p) - start).norm(), 1e-9 * size);
        EXPECT_LE((total_force(p) - momentum).norm(), 1e-10 * p.cwiseAbs().sum());
    }
}

TEST_P(Conservation, FreeFallIsFreeOfStrain) {
    runtime::Settings settings;
    GetParam().set(settings);
    settings.time_step = 0.04;
    settings.conjugate_gradients = {.iterations = 3, .tolerance = 0};  // far too few to converge
    FreeBody free(settings, {1, -9.81, 2});
    const Eigen::Vector3d gravity(1, -9.81, 2);
    constexpr int steps = 25;
    for (int step = 0; step < steps; ++step) {
        const runtime::StepReport report = free.body->step(*free.scheduler);
        EXPECT_FALSE(report.repeated);
    }
    // Implicit Euler: x_n = x_0 + h^2 g n (n + 1) / 2.
    const double distance = settings.time_step * settings.time_step * steps * (steps + 1) / 2;
    const Eigen::VectorXd expected = moved(free.solid.rest(), Eigen::Matrix3d::Identity(), distance * gravity);
    const double fallen = distance * gravity.norm();
    // The fall itself is rounded in double, and what is left at rest is the rounding of the strains, epsilon, whose
    // forces push a node off by less than its element's size times that, in every step anew.
    const double rounding = 4 * steps * GetParam().epsilon() * 0.05 + 0x1p-52 * 50 * fallen;
    EXPECT_LE((positions_of(*free.body) - expected).cwiseAbs().maxCoeff(), rounding);
    const runtime::Energies energies = free.body->energies(*free.scheduler);
    const double strain = 2 * rounding / 0.05;
    double volume = 0;
    for (std::size_t e = 0; e < free.solid.tetrahedra.size(); ++e) volume += free.solid.volume(e);
    EXPECT_LE(energies.elastic, 4e6 * volume * strain * strain);
    EXPECT_LT(energies.elastic, 1e-9 * energies.kinetic);
    const double speed = steps * settings.time_step * gravity.norm();
    EXPECT_NEAR(energies.kinetic, free.mass.sum() / 6 * speed * speed, 1e-4 * energies.kinetic);
    EXPECT_NEAR(energies.gravity, -free.mass.sum() / 3 * distance * gravity.squaredNorm(),
                1e-4 * std::abs(energies.gravity));
}

}  // namespace
}  // namespace lancet::test
