// Loads and displacements that a scene prescribes, in dynamics.
#include <array>
#include <cmath>

#include "tests/runtime/solve/bodies_under_test.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/simulate/loads.hpp"

namespace lancet::test {
namespace {

using runtime::Integrator;

constexpr std::array<int, 3> cells{4, 2, 2};

constexpr std::array integrators{Integrator::implicit_euler, Integrator::implicit_midpoint, Integrator::newmark,
                                 Integrator::symplectic_euler, Integrator::central_differences};

runtime::Settings settings_of(Integrator integrator) {
    runtime::Settings settings = accurate_settings();
    settings.integrator = integrator;
    settings.energy_safeguard = false;
    settings.time_step = 5e-4;
    return settings;
}

class Prescribed : public ::testing::TestWithParam<Integrator> {
  protected:
    ReferenceSolid solid = jittered_bar(cells, 0.1, 0.1, 211);
    std::unique_ptr<runtime::Scheduler> scheduler = serial();
};
INSTANTIATE_TEST_SUITE_P(Integrators, Prescribed, ::testing::ValuesIn(integrators),
                         [](const auto& instance) { return identifier(to_string(instance.param)); });

TEST_P(Prescribed, ComponentsAreReachedAtTheEndOfEveryStep) {
    fix_first_section(solid, cells);
    runtime::Scene scene = scene_of(solid);
    scene.gravity = {0, -9.81, 0};
    const auto along_x = [](double t) { return 0.01 * std::sin(60 * t); };
    const auto along_z = [](double t) { return 0.2 * t * t; };
    scene.prescribed = {{14, 0, along_x}, {14, 2, along_z}, {23, 1, along_x}};
    const auto body = make_body(scene, settings_of(GetParam()), *scheduler);
    // A hold across what is prescribed, and one that meets it: the scene goes before.
    const Eigen::Vector3d rest = solid.rest().segment<3>(3 * 23);
    body->hold(23, {rest[0] + 1, rest[1] + 1, rest[2] + 0.001}, {0, 0, 1});
    for (int step = 1; step <= 20; ++step) {
        if (step == 10) body->hold(23, {rest[0] + 0.002, rest[1] + 1, rest[2] + 0.001});
        body->step(*scheduler);
        const double time = step * 5e-4;
        const Eigen::VectorXd moved = positions_of(*body) - solid.rest();
        EXPECT_NEAR(moved[3 * 14], along_x(time), 1e-15);
        EXPECT_NEAR(moved[3 * 14 + 2], along_z(time), 1e-15);
        EXPECT_NEAR(moved[3 * 23 + 1], along_x(time), 1e-15);
        EXPECT_NEAR(moved[3 * 23 + 2], 0.001, 1e-15);
        if (step >= 10) {
            EXPECT_NEAR(moved[3 * 23], 0.002, 1e-15);
        }
        EXPECT_GT(std::abs(moved[3 * 14 + 1]), 1e-9) << "across it is free";
    }
    body->release_all();
    body->step(*scheduler);
    const Eigen::VectorXd moved = positions_of(*body) - solid.rest();
    EXPECT_NEAR(moved[3 * 23 + 1], along_x(21 * 5e-4), 1e-15) << "release does not end what the scene prescribes";
    EXPECT_GT(std::abs(moved[3 * 23] - 0.002), 1e-9);
}

TEST_P(Prescribed, PlacesAtRestAreFixedNodes) {
    ReferenceSolid fixed = solid;
    fix_first_section(fixed, cells);
    const auto a = make_body(scene_of(fixed), settings_of(GetParam()), *scheduler);
    runtime::Scene scene = scene_of(solid);
    for (const std::int32_t node : fixed.fixed) {
        for (const int axis : {0, 1, 2}) scene.prescribed.push_back({node, axis, [](double) { return 0.0; }});
    }
    const auto b = make_body(scene, settings_of(GetParam()), *scheduler);
    const std::vector<std::uint8_t> is_free = fixed.free_unknowns();
    const Eigen::VectorXd velocity = extended(restricted(random_vector(solid.unknowns(), 0.5, 212), is_free), is_free);
    for (const auto* body : {&a, &b}) (*body)->set_velocities(as_points(velocity));
    for (int step = 0; step < 20; ++step) {
        a->step(*scheduler);
        b->step(*scheduler);
    }
    EXPECT_LE((positions_of(*a) - positions_of(*b)).norm(), 1e-10 * (positions_of(*a) - solid.rest()).norm());
    EXPECT_GT((positions_of(*a) - solid.rest()).norm(), 1e-3);
}

TEST_P(Prescribed, LoadsOfTheSceneActFromTheStart) {
    fix_first_section(solid, cells);
    runtime::Scene scene = scene_of(solid);
    scene.nodal_loads = {{22, {1, 2, 3}}};
    scene.edge_loads = {{{22, 23}, {0, 5, 0}}};
    scene.tractions = {{{{22, 23, 27}}, {10, 0, 20}}};
    const auto a = make_body(scene, settings_of(GetParam()), *scheduler);
    const auto b = make_body(scene_of(solid), settings_of(GetParam()), *scheduler);
    b->set_loads(runtime::external_loads(scene));
    for (int step = 0; step < 5; ++step) {
        a->step(*scheduler);
        b->step(*scheduler);
    }
    EXPECT_EQ(positions_of(*a), positions_of(*b));
    EXPECT_GT((positions_of(*a) - solid.rest()).norm(), 1e-6);
}

TEST(PrescribedDisplacements, ThatMakeNoSenseAreRefused) {
    ReferenceSolid solid = jittered_bar(cells, 0.1, 0.1, 213);
    fix_first_section(solid, cells);
    const auto scheduler = serial();
    const auto still = [](double) { return 0.0; };
    const auto refused = [&](const std::vector<runtime::PrescribedDisplacement>& prescribed, const std::string& text) {
        runtime::Scene scene = scene_of(solid);
        scene.prescribed = prescribed;
        try {
            const auto body = make_body(scene, settings_of(Integrator::implicit_euler), *scheduler);
            body->step(*scheduler);
            ADD_FAILURE() << "no error that says '" << text << "'";
        } catch (const Error& error) {
            EXPECT_THAT(error.what(), ::testing::HasSubstr(text));
        }
    };
    refused({{-1, 0, still}}, "node -1");
    refused({{45, 0, still}}, "node 45");
    refused({{22, 3, still}}, "axis 3");
    refused({{22, 0, {}}}, "function");
    refused({{22, 0, still}, {22, 0, still}}, "twice");
    refused({{solid.fixed.front(), 0, still}}, "fixed");
    refused({{22, 0, [](double) { return std::nan(""); }}}, "not finite");
}

}  // namespace
}  // namespace lancet::test
