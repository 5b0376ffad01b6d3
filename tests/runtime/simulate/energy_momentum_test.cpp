// The scheme of Simo and Tarnow (1992) on a tumbling, vibrating, undamped body of St. Venant-Kirchhoff material: linear
// and angular momentum and the energy are kept as well as each step is solved, where the midpoint rule keeps the
// momenta alone.
#include <algorithm>
#include <cmath>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/simulate/body.hpp"

namespace lancet::test {
namespace {

using mesh::Point;
using runtime::Integrator;

struct Drift {
    double momentum = 0;          ///< of the total momentum, against sum m |v|
    double angular_momentum = 0;  ///< against itself
    double energy = 0;            ///< the largest deviation, against the total
};

/// Steps a box that spins at 6 / s, stretched by 10 % at the start, so that it vibrates too.
Drift tumble(Integrator integrator, double time_step, int steps) {
    runtime::Scene scene;
    scene.mesh = mesh::box({.cells = {2, 1, 1}, .size = {0.2, 0.1, 0.1}});
    scene.materials = {{0, {.young_modulus = 1e5, .poisson_ratio = 0.3, .density = 1000}}};
    scene.gravity = {0, 0, 0};
    runtime::Settings settings;
    settings.integrator = integrator;
    settings.model = runtime::ElementModel::st_venant_kirchhoff;
    settings.tangent = runtime::TangentKind::exact;
    settings.scalar = runtime::ScalarMode::double_precision;
    settings.time_step = time_step;
    settings.energy_safeguard = false;
    settings.newton_iterations = 60;
    settings.newton_tolerance = 1e-12;
    settings.conjugate_gradients = {.iterations = 300, .tolerance = 1e-8};
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    const auto body = make_body(scene, settings, *scheduler);
    const std::size_t nodes = body->nodes();
    std::vector<Point> x(scene.mesh.nodes().begin(), scene.mesh.nodes().end()), v(nodes);
    const Eigen::Vector3d spin(1, 2, 6), centre(0.1, 0.05, 0.05);
    for (std::size_t node = 0; node < nodes; ++node) {
        x[node][0] *= 1.1;
        Eigen::Map<Eigen::Vector3d>(v[node].data()) =
            spin.cross(Eigen::Map<const Eigen::Vector3d>(x[node].data()) - centre) + Eigen::Vector3d(0.1, -0.2, 0.3);
    }
    body->set_positions(x);
    body->set_velocities(v);
    const auto momenta = [&](Eigen::Vector3d& linear, Eigen::Vector3d& angular) {
        body->positions(x);
        body->velocities(v);
        linear.setZero();
        angular.setZero();
        double size = 0;
        for (std::size_t node = 0; node < nodes; ++node) {
            const double mass = body->nodal_mass(static_cast<std::int32_t>(node));
            const Eigen::Map<const Eigen::Vector3d> position(x[node].data()), velocity(v[node].data());
            linear += mass * velocity;
            angular += mass * position.cross(velocity);
            size += mass * velocity.norm();
        }
        return size;
    };
    Eigen::Vector3d linear, angular, linear_now, angular_now;
    const double size = momenta(linear, angular);
    const double energy = body->energies(*scheduler).total();
    Drift drift;
    for (int step = 0; step < steps; ++step) {
        body->step(*scheduler);
        drift.energy = std::max(drift.energy, std::abs(body->energies(*scheduler).total() - energy) / energy);
    }
    momenta(linear_now, angular_now);
    drift.momentum = (linear_now - linear).norm() / size;
    drift.angular_momentum = (angular_now - angular).norm() / angular.norm();
    return drift;
}

TEST(EnergyMomentum, KeepsMomentaAndEnergyOverTenThousandSteps) {
    constexpr int steps = 10000;
    const Drift kept = tumble(Integrator::energy_momentum, 2e-3, steps);
    std::printf("    drift after %d steps: momentum %.2g, angular momentum %.2g, energy %.2g\n", steps, kept.momentum,
                kept.angular_momentum, kept.energy);
    // Each step is solved to 1e-12 of its first residual; roundings and residuals add up.
    EXPECT_LE(kept.momentum, 1e-9);
    EXPECT_LE(kept.angular_momentum, 1e-9);
    EXPECT_LE(kept.energy, 1e-8);
}

TEST(EnergyMomentum, TheMidpointRuleKeepsNoEnergyOfThisMaterial) {
    // What the average stress is for: same body, same steps.
    const Drift midpoint = tumble(Integrator::implicit_midpoint, 2e-3, 500);
    const Drift average = tumble(Integrator::energy_momentum, 2e-3, 500);
    EXPECT_LE(midpoint.momentum, 1e-9);
    EXPECT_LE(midpoint.angular_momentum, 1e-9);
    EXPECT_GT(midpoint.energy, 1e3 * average.energy);
    std::printf("    energy: midpoint %.2g, average stress %.2g\n", midpoint.energy, average.energy);
}

TEST(EnergyMomentum, IsRefusedForTheCorotationalModel) {
    runtime::Scene scene;
    scene.mesh = mesh::box({});
    runtime::Settings settings;
    settings.integrator = Integrator::energy_momentum;
    settings.energy_safeguard = false;
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    EXPECT_THROW(make_body(scene, settings, *scheduler), Error);
}

}  // namespace
}  // namespace lancet::test
