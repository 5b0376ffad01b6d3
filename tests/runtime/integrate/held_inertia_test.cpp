// Held nodes that accelerate carry their neighbours along, through a consistent mass too.
#include <array>
#include <cmath>

#include "tests/runtime/solve/bodies_under_test.hpp"
#include <gtest/gtest.h>

namespace lancet::test {
namespace {

using runtime::ElementModel;
using runtime::Integrator;
using runtime::MassKind;

constexpr std::array<int, 3> cells{4, 2, 2};

class HeldInertia : public ::testing::TestWithParam<std::tuple<Integrator, MassKind>> {
  protected:
    ReferenceSolid solid = jittered_bar(cells, 0.1, 0.1, 241);
    std::unique_ptr<runtime::Scheduler> scheduler = serial();

    static runtime::Settings settings() {
        runtime::Settings settings = accurate_settings(1e-13);
        settings.integrator = std::get<0>(GetParam());
        // The average stress is that of the other model.
        set_model(settings, settings.integrator == Integrator::energy_momentum ? ElementModel::st_venant_kirchhoff
                                                                               : ElementModel::corotational);
        settings.mass = std::get<1>(GetParam());
        settings.energy_safeguard = false;
        settings.newton_iterations = 50;
        settings.newton_tolerance = 1e-11;
        settings.time_step = 0.005;
        return settings;
    }
};
INSTANTIATE_TEST_SUITE_P(Bodies, HeldInertia,
                         ::testing::Combine(::testing::Values(Integrator::implicit_euler, Integrator::implicit_midpoint,
                                                              Integrator::energy_momentum, Integrator::newmark),
                                            ::testing::ValuesIn(all_masses)),
                         [](const auto& instance) {
                             return identifier(to_string(std::get<0>(instance.param))) + "_" +
                                    std::string(to_string(std::get<1>(instance.param)));
                         });

TEST_P(HeldInertia, OfABaseThatAcceleratesIsAWeight) {
    // A base that is led along a t^2 / 2 is at rest in a frame where -a is a weight. That holds for the discrete
    // equations as well: displacements that are added to all nodes change differences neither in space nor, but for
    // a, of velocities in time.
    const Eigen::Vector3d acceleration(20, -30, 10);
    const double h = settings().time_step;
    ReferenceSolid clamped = solid;
    fix_first_section(clamped, cells);
    runtime::Scene still = scene_of(clamped);
    for (std::size_t axis = 0; axis < 3; ++axis) still.gravity[axis] = -acceleration[static_cast<Eigen::Index>(axis)];
    const auto at_rest = make_body(still, settings(), *scheduler);

    runtime::Scene led = scene_of(solid);
    for (const std::int32_t node : clamped.fixed) {
        for (const int axis : {0, 1, 2}) {
            led.prescribed.push_back({node, axis, [a = acceleration[axis]](double t) { return a * t * t / 2; }});
        }
    }
    const auto moving = make_body(led, settings(), *scheduler);
    // Velocities of the base are those of the middle of a step, and implicit Euler's are all of that kind.
    Eigen::VectorXd velocity = Eigen::VectorXd::Zero(solid.unknowns());
    const auto start_late = [&](std::int32_t node) { velocity.segment<3>(3 * node) = -h / 2 * acceleration; };
    if (settings().integrator == Integrator::implicit_euler) {
        for (std::int32_t node = 0; node < static_cast<std::int32_t>(solid.nodes.size()); ++node) start_late(node);
    }
    for (const std::int32_t node : clamped.fixed) start_late(node);
    moving->set_velocities(as_points(velocity));

    for (int step = 1; step <= 20; ++step) {
        at_rest->step(*scheduler);
        moving->step(*scheduler);
        Eigen::VectorXd relative = positions_of(*moving);
        const double time = step * h;
        for (Eigen::Index i = 0; i < relative.size(); i += 3) relative.segment<3>(i) -= time * time / 2 * acceleration;
        const Eigen::VectorXd expected = positions_of(*at_rest);
        // Each step is solved to 1e-11 of its loads.
        EXPECT_LE((relative - expected).norm(), 1e-8 * (expected - solid.rest()).norm()) << "step " << step;
    }
    EXPECT_GT((positions_of(*at_rest) - solid.rest()).norm(), 0.01);
}

TEST_P(HeldInertia, OfANodeThatIsStoppedObeysTheEquationsOfImpact) {
    // A body that flies without strain, and a node of it that is stopped: in a step so short that stress cannot act,
    // M_ff dv_f = -M_fi dv_i.
    const auto& [integrator, mass_kind] = GetParam();
    runtime::Settings brief = settings();
    brief.time_step = 1e-9;
    const auto body = make_body(scene_of(solid), brief, *scheduler);
    const Eigen::Vector3d flight(1, -2, 0.5);
    body->set_velocities(as_points(flight.replicate(solid.unknowns() / 3, 1)));
    constexpr std::int32_t stopped = 22;
    body->hold(stopped, solid.nodes[stopped]);
    body->step(*scheduler);
    const Eigen::MatrixXd mass = solid.mass(mass_kind == MassKind::consistent);
    std::vector<std::uint8_t> is_free(static_cast<std::size_t>(solid.unknowns()), 1);
    for (const int axis : {0, 1, 2}) is_free[3 * stopped + axis] = 0;
    Eigen::VectorXd jump = Eigen::VectorXd::Zero(solid.unknowns());
    jump.segment<3>(3 * stopped) = -flight;
    const Eigen::VectorXd reply =
        extended(restricted(mass, is_free).llt().solve(restricted(Eigen::VectorXd(-mass * jump), is_free)), is_free);
    const Eigen::VectorXd expected = Eigen::VectorXd(flight.replicate(solid.unknowns() / 3, 1)) + jump + reply;
    // Velocities are differences of positions of size 1 over 1e-9 s, known to 1e-16.
    EXPECT_LE((velocities_of(*body) - expected).norm(), 1e-6 * expected.norm());
    EXPECT_EQ(reply.norm() > 0.01, mass_kind == MassKind::consistent);
}

}  // namespace
}  // namespace lancet::test
