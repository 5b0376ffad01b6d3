// Scenes, settings and calls that make no sense: one clear error each.
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "tests/runtime/solve/bodies_under_test.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::test {
namespace {

using ::testing::HasSubstr;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

runtime::Scene good_scene() {
    ReferenceSolid solid = jittered_bar({3, 2, 2}, 0.1, 0.1, 121);
    fix_first_section(solid, {3, 2, 2});
    return scene_of(solid);
}

template <class Function>
void expect_error(const Function& function, const std::string& text) {
    try {
        function();
        ADD_FAILURE() << "no error that says '" << text << "'";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr(text));
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "one line";
    }
}

void expect_bad_scene(const std::function<void(runtime::Scene&)>& change, const std::string& text) {
    const auto scheduler = serial();
    runtime::Scene scene = good_scene();
    change(scene);
    expect_error([&] { make_body(scene, {}, *scheduler); }, text);
}

void expect_bad_settings(const std::function<void(runtime::Settings&)>& change, const std::string& text) {
    const auto scheduler = serial();
    runtime::Settings settings;
    change(settings);
    expect_error([&] { make_body(good_scene(), settings, *scheduler); }, text);
}

TEST(BadScene, IsRefused) {
    EXPECT_NO_THROW(make_body(good_scene(), {}, *serial()));
    expect_bad_scene([](auto& s) { s.fixed_nodes.push_back(36); }, "fixed node 36");
    expect_bad_scene([](auto& s) { s.fixed_nodes.push_back(-1); }, "fixed node -1");
    expect_bad_scene([](auto& s) { s.mesh = mesh::TetMesh(); }, "no elements");
    expect_bad_scene([](auto& s) { s.materials.erase(0); }, "region 0");
    expect_bad_scene([](auto& s) { s.materials.clear(); }, "region 0");
    const auto with_part = [](runtime::Scene& scene) -> mesh::PartMoments& {
        scene.parts.place.assign(scene.mesh.tetrahedra().size(), -1);
        scene.parts.place[3] = 0;
        scene.parts.moments.resize(1);
        return scene.parts.moments[0];
    };
    for (const double bad : {0.0, -0.5, nan, static_cast<double>(HUGE_VAL)}) {
        expect_bad_scene([&](auto& s) { with_part(s).fraction = bad; }, "part of element 3");
    }
    for (const double bad : {-0.5, nan, static_cast<double>(HUGE_VAL)}) {
        expect_bad_scene([&](auto& s) { with_part(s).first[2] = bad; }, "part of element 3");
        expect_bad_scene([&](auto& s) { with_part(s).second[1][2] = bad; }, "part of element 3");
    }
    expect_bad_scene([&](auto& s) { with_part(s), s.parts.place.pop_back(); }, "scene: parts for");
    expect_bad_scene([&](auto& s) { with_part(s), s.parts.place[1] = 1; }, "element 1 has the moments 1");
    for (const double poisson : {0.5, 0.7, -1.0, nan}) {
        expect_bad_scene([&](auto& s) { s.materials[1].poisson_ratio = poisson; }, "Poisson");
    }
    for (const double bad : {0.0, -1.0, nan, HUGE_VAL}) {
        expect_bad_scene([&](auto& s) { s.materials[0].young_modulus = bad; }, "Young");
        expect_bad_scene([&](auto& s) { s.materials[0].density = bad; }, "density");
    }
    expect_bad_scene([](auto& s) { s.gravity[1] = nan; }, "gravity");
    expect_bad_scene([](auto& s) { s.rayleigh_mass = -1; }, "damping");
    expect_bad_scene([](auto& s) { s.rayleigh_stiffness = HUGE_VAL; }, "damping");
}

TEST(BadScene, RegionsWithoutAMaterialTakeThatOfRegionZero) {
    const auto scheduler = serial();
    runtime::Scene scene = good_scene(), named = good_scene();
    scene.materials.erase(1);
    named.materials[1] = named.materials.at(0);
    const auto body = make_body(scene, {}, *scheduler), same = make_body(named, {}, *scheduler);
    for (std::int32_t node = 0; node < 36; ++node) EXPECT_EQ(body->nodal_mass(node), same->nodal_mass(node));
}

TEST(BadSettings, AreRefused) {
    for (const double step : {0.0, -0.01, nan, HUGE_VAL}) {
        expect_bad_settings([&](auto& s) { s.time_step = step; }, "time step");
    }
    expect_bad_settings([](auto& s) { s.conjugate_gradients.iterations = 0; }, "conjugate gradients");
    for (const double tolerance : {-1e-6, 1.0, nan}) {
        expect_bad_settings([&](auto& s) { s.conjugate_gradients.tolerance = tolerance; }, "tolerance");
    }
    expect_bad_settings([](auto& s) { s.rotation_interval = 0; }, "rotation interval");
    expect_bad_settings([](auto& s) { s.rotation_bound = -1; }, "rotations stay");
    expect_bad_settings([](auto& s) { s.rotation_bound = 0.1, s.tangent = kernels::TangentKind::exact; },
                        "rotation bound");
    expect_bad_settings([](auto& s) { s.rotation_interval = 5; }, "rotation interval");
    expect_bad_settings([](auto& s) { s.rotation.steps = 0; }, "rotation");
    expect_bad_settings([](auto& s) { s.newton_iterations = 0; }, "Newton");
    for (const double tolerance : {0.0, -1.0, nan}) {
        expect_bad_settings([&](auto& s) { s.newton_tolerance = tolerance; }, "Newton");
    }
    for (const double change : {-0.1, nan}) {
        expect_bad_settings([&](auto& s) { s.coarse_change = change; }, "coarse");
    }
    expect_bad_settings([](auto& s) { s.integrator = runtime::Integrator::implicit_midpoint; }, "safeguard");
    expect_bad_settings(
        [](auto& s) {
            s.newton_iterations = 3;
            s.linearisation = runtime::Linearisation::state;
        },
        "Newton");
    expect_bad_settings([](auto& s) { s.safeguard_iterations = -1; }, "safeguard");
    expect_bad_settings([](auto& s) { s.numbering.nodes_per_block = -5; }, "nodes");
    expect_bad_settings([](auto& s) { s.numbering.nodes_per_aggregate = -5; }, "nodes");
    for (const auto instruction_set : kernels::compiled_instruction_sets()) {
        if (kernels::is_executable(instruction_set)) continue;
        expect_bad_settings([&](auto& s) { s.instruction_set = instruction_set; },
                            std::string(to_string(instruction_set)));
    }
}

TEST(BadCall, IsRefused) {
    const auto scheduler = serial();
    const auto body = make_body(good_scene(), {}, *scheduler);
    const Point place{0.1, 0.1, 0.1};
    expect_error([&] { body->hold(0, place); }, "fixed");
    expect_error([&] { body->hold(36, place); }, "node 36");
    expect_error([&] { body->hold(-1, place); }, "node -1");
    expect_error([&] { body->hold(5, {nan, 0, 0}); }, "not finite");
    expect_error([&] { body->hold(5, place, {1, 1, 0}); }, "length");
    expect_error([&] { body->hold(5, place, {0, 0, 0}); }, "length");
    expect_error([&] { body->hold(5, place, {nan, 0, 0}); }, "length");
    expect_error([&] { body->release(36); }, "node 36");
    expect_error([&] { static_cast<void>(body->nodal_mass(-1)); }, "node -1");

    std::vector<Point> values(36, place), few(35, place);
    expect_error([&] { body->set_positions(few); }, "35 positions");
    expect_error([&] { body->set_velocities(few); }, "35 velocities");
    expect_error([&] { body->set_loads(few); }, "35 loads");
    expect_error([&] { body->positions(few); }, "36 nodes");
    expect_error([&] { body->velocities(few); }, "36 nodes");
    expect_error([&] { body->elastic_forces(*scheduler, few); }, "36 nodes");
    expect_error([&] { body->apply_matrix(*scheduler, few, values); }, "36 nodes");
    expect_error([&] { body->apply_matrix(*scheduler, values, few); }, "36 nodes");
    values[7][2] = nan;
    expect_error([&] { body->set_positions(values); }, "position of node 7");
    expect_error([&] { body->set_velocities(values); }, "velocity of node 7");
    values[7][2] = HUGE_VAL;
    expect_error([&] { body->set_loads(values); }, "load of node 7");
    // Nothing of what was refused is left behind.
    body->step(*scheduler);
    EXPECT_LE((positions_of(*body) - as_vector(good_scene().mesh.nodes())).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(FullyFixedBody, StandsStill) {
    const auto scheduler = serial();
    for (const auto preconditioner : all_preconditioners) {
        for (const auto kind : all_operators) {
            runtime::Scene scene = good_scene();
            scene.gravity = {0, -9.81, 0};
            scene.fixed_nodes.clear();
            for (std::int32_t node = 0; node < 36; ++node) scene.fixed_nodes.push_back(node);
            runtime::Settings settings;
            settings.preconditioner = preconditioner;
            settings.matrix = kind;
            const auto body = make_body(scene, settings, *scheduler);
            for (int step = 0; step < 3; ++step) EXPECT_FALSE(body->step(*scheduler).lost);
            EXPECT_EQ(positions_of(*body), as_vector(scene.mesh.nodes()));
            EXPECT_EQ(body->energies(*scheduler).total(), 0);
        }
    }
}

TEST(FixedNodes, MayBeNamedTwiceAndCarryLoads) {
    const auto scheduler = serial();
    runtime::Scene scene = good_scene();
    scene.fixed_nodes.insert(scene.fixed_nodes.end(), scene.fixed_nodes.begin(), scene.fixed_nodes.end());
    const auto body = make_body(scene, {}, *scheduler);
    std::vector<Point> loads(36, Point{0, 0, 0});
    for (const std::int32_t node : scene.fixed_nodes) loads[node] = {1e6, 0, 0};
    body->set_loads(loads);
    body->step(*scheduler);
    EXPECT_LE((positions_of(*body) - as_vector(scene.mesh.nodes())).cwiseAbs().maxCoeff(), 1e-6);
}

}  // namespace
}  // namespace lancet::test
