// Bodies without a cut, against 20-node hexahedra, beam theory and the elastica: shared/reference/standards.
#include <cmath>
#include <functional>

#include "tests/verification/convergence.hpp"
#include <gtest/gtest.h>

#include "lancet/mesh/boundary.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/simulate/equilibrium.hpp"
#include "lancet/runtime/simulate/scene_layout.hpp"

namespace lancet::test {
namespace {

using mesh::Point;
using runtime::ElementModel;

std::vector<Point> equilibrium(const runtime::Scene& scene, ElementModel model, runtime::EquilibriumReport& report) {
    runtime::EquilibriumSettings settings;
    settings.model = model;
    settings.tolerance = 1e-8;
    const auto scheduler = runtime::make_scheduler(runtime::default_scheduler, 2);
    std::vector<Point> positions(scene.mesh.nodes().begin(), scene.mesh.nodes().end());
    report = find_equilibrium(scene, settings, *scheduler, positions);
    return positions;
}

/// The displacement of the node at a place.
Point displacement_at(const runtime::Scene& scene, std::span<const Point> positions, const Point& place) {
    for (std::size_t node = 0; node < positions.size(); ++node) {
        const Point& p = scene.mesh.nodes()[node];
        if (std::hypot(p[0] - place[0], p[1] - place[1], p[2] - place[2]) > 1e-9) continue;
        return {positions[node][0] - p[0], positions[node][1] - p[1], positions[node][2] - p[2]};
    }
    ADD_FAILURE() << "no node at " << place[0] << ", " << place[1] << ", " << place[2];
    return {};
}

runtime::Scene clamped_box(const mesh::Box& box, const char* clamped, const runtime::Material& material) {
    runtime::Scene scene;
    scene.mesh = mesh::box(box);
    const auto nodes = scene.mesh.node_set(clamped);
    scene.fixed_nodes.assign(nodes.begin(), nodes.end());
    scene.materials = {{0, material}};
    scene.gravity = {0, 0, 0};
    return scene;
}

/// The Bar: 4 or 1 m long, clamped at x = 0, under gravity along -y.
runtime::Scene bar(double length, int refinement) {
    runtime::Scene scene = clamped_box(
        {.cells = {10 * refinement, 2 * refinement, 2 * refinement}, .size = {length, length / 5, length / 5}}, "x_min",
        {.young_modulus = 1e5, .poisson_ratio = 0.33, .density = 100});
    scene.gravity = {0, -9.81, 0};
    return scene;
}

TEST(Standards, BarRestState) {
    // bar_gravity.csv: corot, k = 2 and 3; three digits for the long bar, four for the short one.
    struct Reference {
        double length, deflection, shortening, digits;
    };
    for (const Reference& reference : {Reference{1, 0.34383, 0.06690, 2e-4}, Reference{4, 3.126, 1.649, 2e-3}}) {
        SCOPED_TRACE(reference.length);
        Convergence deflection{}, shortening{};
        for (std::size_t k = 0; k < 3; ++k) {
            const runtime::Scene scene = bar(reference.length, 2 << k);
            runtime::EquilibriumReport report;
            const auto positions = equilibrium(scene, ElementModel::corotational, report);
            EXPECT_EQ(report.end, runtime::EquilibriumEnd::converged) << report.explanation;
            const Point tip =
                displacement_at(scene, positions, {reference.length, reference.length / 10, reference.length / 10});
            deflection.value[k] = -tip[1];
            shortening.value[k] = -tip[0];
        }
        expect_converges_to("deflection", deflection, reference.deflection, reference.digits);
        expect_converges_to("shortening", shortening, reference.shortening, reference.digits);
    }
}

TEST(Standards, TheLongBarOfStVenantAndKirchhoffsMaterialIsNotReportedAsAnEquilibriumOfTheRestState) {
    // bar_gravity.csv: 'svk collapses on the 4 m bar'. Either the search says so, or what it finds is an equilibrium.
    const runtime::Scene scene = bar(4, 4);
    runtime::EquilibriumReport report;
    equilibrium(scene, ElementModel::st_venant_kirchhoff, report);
    EXPECT_NE(report.end, runtime::EquilibriumEnd::converged) << report.explanation;
    EXPECT_LT(report.load_factor, 1);
    EXPECT_GT(report.load_factor, 0.01);
    std::printf("    %s\n", report.explanation.c_str());
}

TEST(Standards, UncutBeam) {
    // beams_gravity.csv: tip_center_ux, tip_center_uz of the finest mesh; its own change from mesh to mesh is 2e-4.
    struct Reference {
        ElementModel model;
        double deflection, rise;
    };
    for (const Reference& reference : {Reference{ElementModel::linear, 0.0925099188, 0},
                                       Reference{ElementModel::corotational, 0.0809169429, -0.0192477718},
                                       Reference{ElementModel::st_venant_kirchhoff, 0.0810905669, -0.0196596893}}) {
        SCOPED_TRACE(to_string(reference.model));
        Convergence deflection{}, rise{};
        for (std::size_t k = 0; k < 3; ++k) {
            const int n = 1 << k;
            runtime::Scene scene = clamped_box({.cells = {4 * n, 8 * n, 26 * n}, .size = {0.03, 0.06, 0.2}}, "z_min",
                                               {.young_modulus = 3e5, .poisson_ratio = 0.35, .density = 1070});
            scene.gravity = {9.81, 0, 0};
            runtime::EquilibriumReport report;
            const auto positions = equilibrium(scene, reference.model, report);
            EXPECT_EQ(report.end, runtime::EquilibriumEnd::converged) << report.explanation;
            const Point tip = displacement_at(scene, positions, {0.015, 0.03, 0.2});
            deflection.value[k] = tip[0];
            rise.value[k] = tip[2];
        }
        expect_converges_to("deflection", deflection, reference.deflection, 3e-4);
        if (reference.rise != 0) expect_converges_to("shortening", rise, reference.rise, 5e-4);
    }
}

TEST(Standards, CookMembrane) {
    // cook_membrane.csv: plane-stress-equivalent, E* = 0.9375, nu* = 0.25, u_z = 0: u_y(48, 52) = 23.967.
    Convergence middle{};
    for (std::size_t k = 0; k < 3; ++k) {
        const int n = 32 << k;
        mesh::TetMesh::Definition definition = mesh::box({.cells = {n, n, 1}, .size = {48, 1, 1}}).definition();
        for (Point& p : definition.nodes) {
            const double low = 44 * p[0] / 48, high = 44 + 16 * p[0] / 48;
            p[1] = low + p[1] * (high - low);
        }
        runtime::Scene scene;
        scene.mesh = mesh::TetMesh(std::move(definition));
        const auto clamped = scene.mesh.node_set("x_min");
        scene.fixed_nodes.assign(clamped.begin(), clamped.end());
        for (std::size_t node = 0; node < scene.mesh.nodes().size(); ++node) {
            if (scene.mesh.nodes()[node][0] == 0) continue;
            scene.prescribed.push_back({static_cast<std::int32_t>(node), 2, [](double) { return 0.0; }});
        }
        scene.materials = {{0, {.young_modulus = 0.9375, .poisson_ratio = 0.25, .density = 1}}};
        scene.gravity = {0, 0, 0};
        const mesh::Boundary boundary = mesh::boundary(scene.mesh);
        scene.tractions.push_back(
            {runtime::triangles_where(scene.mesh, boundary.triangles, [](const Point& p) { return p[0] > 48 - 1e-9; }),
             {0, 1.0 / 16, 0}});
        runtime::EquilibriumReport report;
        const auto positions = equilibrium(scene, ElementModel::linear, report);
        EXPECT_EQ(report.end, runtime::EquilibriumEnd::converged) << report.explanation;
        middle.value[k] = displacement_at(scene, positions, {48, 52, 0})[1];
    }
    expect_converges_to("u_y", middle, 23.967, 2e-4);
}

/// A slender beam that is clamped at x = 0, against the elastica: inextensible and without shear, which a beam of
/// L / h = 20 and nu = 0 has to (h / L)^2 of its deflection.
struct SlenderBeam {
    static constexpr double length = 1, height = 0.05, young = 1e6;
    static constexpr double section = height * height, bending = young * section * section / 12;

    /// Expects the tip's place under what `load(scene)` adds to the beam.
    static void expect_tip(double deflection, double shortening, const std::function<void(runtime::Scene&)>& load) {
        Convergence down{}, back{};
        for (std::size_t k = 0; k < 3; ++k) {
            const int n = 2 << k;
            runtime::Scene scene = clamped_box({.cells = {20 * n, n, n}, .size = {length, height, height}}, "x_min",
                                               {.young_modulus = young, .poisson_ratio = 0, .density = 1});
            load(scene);
            runtime::EquilibriumReport report;
            const auto positions = equilibrium(scene, ElementModel::corotational, report);
            EXPECT_EQ(report.end, runtime::EquilibriumEnd::converged) << report.explanation;
            const Point tip = displacement_at(scene, positions, {length, height / 2, height / 2});
            down.value[k] = -tip[1];
            back.value[k] = -tip[0];
        }
        constexpr double slenderness = section / (length * length);
        expect_converges_to("deflection", down, deflection, slenderness);
        expect_converges_to("shortening", back, shortening, 2 * slenderness);
    }
};

TEST(Standards, ElasticaWithAnEndLoad) {
    // elastica_end_load.csv, P L^2 / E I = 2.
    SlenderBeam::expect_tip(0.493457480, 0.160641721, [](runtime::Scene& scene) {
        constexpr double force = 2 * SlenderBeam::bending / (SlenderBeam::length * SlenderBeam::length);
        const mesh::Boundary boundary = mesh::boundary(scene.mesh);
        scene.tractions.push_back(
            {runtime::triangles_where(scene.mesh, boundary.triangles,
                                      [](const Point& p) { return p[0] > SlenderBeam::length - 1e-9; }),
             {0, -force / SlenderBeam::section, 0}});
    });
}

TEST(Standards, ElasticaUnderItsOwnWeight) {
    // elastica_uniform_load.csv: q L^3 / E I, and the tip's deflection and shortening over L.
    struct Reference {
        double parameter, deflection, shortening;
    };
    for (const Reference& reference :
         {Reference{2, 0.238506583, 0.033107053}, Reference{8, 0.640630717, 0.275575266}}) {
        SCOPED_TRACE(reference.parameter);
        SlenderBeam::expect_tip(reference.deflection, reference.shortening, [&](runtime::Scene& scene) {
            constexpr double cubed_length = SlenderBeam::length * SlenderBeam::length * SlenderBeam::length;
            const double force_per_length = reference.parameter * SlenderBeam::bending / cubed_length;
            scene.gravity = {0, -9.81, 0};
            scene.materials.at(0).density = force_per_length / (9.81 * SlenderBeam::section);
        });
    }
}

/// The lowest frequency in Hz by inverse iteration: each step is a static problem under the forces M u.
double lowest_frequency(const runtime::Scene& rest, const Point& start) {
    runtime::Scene scene = rest;
    const std::size_t nodes = scene.mesh.nodes().size();
    const kernels::NodeNumbering numbering =
        runtime::number_scene(scene, mesh::OrderingKind::none, kernels::NumberingOptions{});
    const std::vector<double> internal = nodal_masses(scene, element_materials(scene), numbering);
    std::vector<Point> motion(nodes, start);
    double frequency = 0;
    for (int iteration = 0; iteration < 8; ++iteration) {
        scene.nodal_loads.clear();
        for (std::size_t node = 0; node < nodes; ++node) {
            const double mass = internal[static_cast<std::size_t>(numbering.internal_of_user[node])];
            scene.nodal_loads.push_back({static_cast<std::int32_t>(node),
                                         {mass * motion[node][0], mass * motion[node][1], mass * motion[node][2]}});
        }
        runtime::EquilibriumReport report;
        const auto positions = equilibrium(scene, ElementModel::linear, report);
        // With K w = M u: the Rayleigh quotient of w is w.Mu / w.Mw.
        double upper = 0, lower = 0, largest = 0;
        for (std::size_t node = 0; node < nodes; ++node) {
            const double mass = internal[static_cast<std::size_t>(numbering.internal_of_user[node])];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double w = positions[node][axis] - scene.mesh.nodes()[node][axis];
                upper += w * scene.nodal_loads[node].force[axis];
                lower += mass * w * w;
                motion[node][axis] = w;
                largest = std::max(largest, std::abs(w));
            }
        }
        for (Point& m : motion) m = {m[0] / largest, m[1] / largest, m[2] / largest};
        frequency = std::sqrt(upper / lower) / (2 * M_PI);
    }
    return frequency;
}

TEST(Standards, LowestFrequencies) {
    // frequency.csv (CalculiX, consistent mass): k = 2; its own change from mesh to mesh is 5e-4.
    Convergence beam{}, short_bar{};
    for (std::size_t k = 0; k < 3; ++k) {
        const int n = 1 << k;
        beam.value[k] =
            lowest_frequency(clamped_box({.cells = {4 * n, 8 * n, 26 * n}, .size = {0.03, 0.06, 0.2}}, "z_min",
                                         {.young_modulus = 3e5, .poisson_ratio = 0.35, .density = 1070}),
                             {1, 0, 0});
        runtime::Scene scene = bar(1, 2 * n);
        scene.gravity = {0, 0, 0};
        short_bar.value[k] = lowest_frequency(scene, {0, 1, 0});
    }
    expect_converges_to("beam", beam, 2.025913, 6e-4);
    expect_converges_to("bar", short_bar, 1.000986, 6e-4);
}

TEST(Standards, UniaxialStretchHasTheClosedFormsStress) {
    // analytic.csv: E = 3e5, nu = 0.35, l = 1.2, laterally fixed: nominal stress 127111.11 (svk), 96296.296 (corot).
    for (const auto& [model, stress] : {std::pair{ElementModel::st_venant_kirchhoff, 127111.111111},
                                        std::pair{ElementModel::corotational, 96296.2962963}}) {
        SCOPED_TRACE(to_string(model));
        runtime::Scene scene;
        scene.mesh = mesh::box({.cells = {3, 2, 2}, .size = {1, 1, 1}});
        scene.materials = {{0, {.young_modulus = 3e5, .poisson_ratio = 0.35, .density = 1}}};
        scene.gravity = {0, 0, 0};
        for (std::size_t node = 0; node < scene.mesh.nodes().size(); ++node) {
            const auto n = static_cast<std::int32_t>(node);
            const double x = scene.mesh.nodes()[node][0];
            scene.prescribed.push_back({n, 1, [](double) { return 0.0; }});
            scene.prescribed.push_back({n, 2, [](double) { return 0.0; }});
            if (x == 0) scene.prescribed.push_back({n, 0, [](double) { return 0.0; }});
        }
        const mesh::Boundary boundary = mesh::boundary(scene.mesh);
        scene.tractions.push_back(
            {runtime::triangles_where(scene.mesh, boundary.triangles, [](const Point& p) { return p[0] > 1 - 1e-9; }),
             {stress, 0, 0}});
        runtime::EquilibriumReport report;
        const auto positions = equilibrium(scene, model, report);
        EXPECT_EQ(report.end, runtime::EquilibriumEnd::converged) << report.explanation;
        for (std::size_t node = 0; node < positions.size(); ++node) {
            // The residual's tolerance, and the twelve digits of the stress.
            EXPECT_NEAR(positions[node][0], 1.2 * scene.mesh.nodes()[node][0], 1e-7);
        }
    }
}

}  // namespace
}  // namespace lancet::test
