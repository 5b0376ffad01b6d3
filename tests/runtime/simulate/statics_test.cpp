// How the static search ends, and what it refuses. The answers themselves are verified in tests/verification.
#include <cmath>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/boundary.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/simulate/equilibrium.hpp"
#include "lancet/runtime/simulate/scene_layout.hpp"

namespace lancet::test {
namespace {

using mesh::Point;
using runtime::ElementModel;
using runtime::EquilibriumEnd;

constexpr double young = 1e5;

runtime::Scene box(const std::array<int, 3>& cells, const std::array<double, 3>& size) {
    runtime::Scene scene;
    scene.mesh = mesh::box({.cells = cells, .size = size});
    scene.materials = {{0, {.young_modulus = young, .poisson_ratio = 0.3, .density = 1000}}};
    scene.gravity = {0, 0, 0};
    return scene;
}

void clamp(runtime::Scene& scene, const char* set) {
    const auto nodes = scene.mesh.node_set(set);
    scene.fixed_nodes.assign(nodes.begin(), nodes.end());
}

runtime::Traction pull_end(const mesh::TetMesh& mesh, const Point& force_per_area) {
    const double end = mesh.bounds()[1][0];
    const mesh::Boundary boundary = mesh::boundary(mesh);
    return {runtime::triangles_where(mesh, boundary.triangles, [&](const Point& p) { return p[0] > end - 1e-9; }),
            force_per_area};
}

struct Found {
    runtime::EquilibriumReport report;
    std::vector<Point> positions;
};

Found find(const runtime::Scene& scene, const runtime::EquilibriumSettings& settings) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    Found found{{}, {scene.mesh.nodes().begin(), scene.mesh.nodes().end()}};
    found.report = find_equilibrium(scene, settings, *scheduler, found.positions);
    return found;
}

std::string refusal(const std::function<void()>& call) {
    try {
        call();
    } catch (const Error& error) {
        return error.what();
    }
    ADD_FAILURE() << "nothing was refused";
    return {};
}

// A column under its buckling load twice over. The buckling load of the mesh, which locking makes stiffer than beam
// theory's, follows from the deflection under a small load across: P = pi^2 E I / 4 L^2 with E I = F L^3 / 3 w.
TEST(Statics, AColumnLosesItsStabilityAtItsBucklingLoad) {
    constexpr double length = 1, height = 0.1, area = height * height;
    runtime::Scene scene = box({20, 2, 2}, {length, height, height});
    clamp(scene, "x_min");
    scene.tractions = {pull_end(scene.mesh, {0, 1e-3 / area, 0})};
    runtime::EquilibriumSettings settings;
    settings.tolerance = 1e-8;
    settings.model = ElementModel::linear;
    const Found across = find(scene, settings);
    ASSERT_EQ(across.report.end, EquilibriumEnd::converged) << across.report.explanation;
    const double deflection = 2 * across.report.elastic_energy / 1e-3;
    const double buckling = M_PI * M_PI / 4 * (1e-3 * length / 3 / deflection);
    scene.tractions = {pull_end(scene.mesh, {-2 * buckling / area, 0, 0})};
    for (const auto model : {ElementModel::corotational, ElementModel::st_venant_kirchhoff}) {
        SCOPED_TRACE(to_string(model));
        settings.model = model;
        const Found found = find(scene, settings);
        EXPECT_EQ(found.report.end, EquilibriumEnd::lost_stability) << found.report.explanation;
        // Shear takes 1.2 pi^2 E I / (4 G A L^2) = 0.6 % off, the shortened column gives 2 %.
        EXPECT_NEAR(found.report.load_factor, 0.5, 0.02) << found.report.explanation;
        EXPECT_THAT(found.report.explanation, testing::HasSubstr("indefinite"));
        // What is returned is the last equilibrium: the straight column, shortened.
        EXPECT_LE(found.report.residual, 1e-4);
        double tip = 0;
        for (const Point& p : found.positions) tip = std::max(tip, p[0]);
        EXPECT_NEAR(tip, length - found.report.load_factor * 2 * buckling * length / (young * area), 2e-3);
    }
}

TEST(Statics, RoundingInFloatIsNamedWhereItIsWhatStopsTheSearch) {
    runtime::Scene scene = box({6, 2, 2}, {1, 1.0 / 3, 1.0 / 3});
    clamp(scene, "x_min");
    scene.gravity = {0, -9.81, 0};
    runtime::Material hard = scene.materials.at(0);
    hard.young_modulus *= 1e6;
    scene.materials[1] = hard;
    auto definition = scene.mesh.definition();
    for (std::size_t e = 0; e < definition.regions.size(); ++e) definition.regions[e] = e % 3 == 0 ? 1 : 0;
    scene.mesh = mesh::TetMesh(std::move(definition));
    runtime::EquilibriumSettings settings;
    settings.tolerance = 1e-4;
    settings.scalar = runtime::ScalarMode::single_precision;
    const Found single = find(scene, settings);
    EXPECT_EQ(single.report.end, EquilibriumEnd::stagnated);
    EXPECT_GT(single.report.residual, settings.tolerance);
    EXPECT_THAT(single.report.explanation, testing::HasSubstr("stagnated at a residual of"));
    EXPECT_THAT(single.report.explanation, testing::HasSubstr("mixed or double"));
    EXPECT_EQ(single.report.load_steps, 0);  // smaller loads are not tried: they only drown sooner
    settings.scalar = runtime::ScalarMode::double_precision;
    EXPECT_EQ(find(scene, settings).report.end, EquilibriumEnd::converged);
    // What is no matter of rounding is still called what it is: a column under twice its buckling load.
    runtime::Scene column = box({20, 2, 2}, {1, 0.1, 0.1});
    clamp(column, "x_min");
    column.tractions = {pull_end(column.mesh, {-2 * M_PI * M_PI / 4 * young * 0.01 / 12, 0, 0})};
    settings.scalar = runtime::ScalarMode::single_precision;
    settings.tolerance = 1e-3;
    const Found buckled = find(column, settings);
    EXPECT_THAT(buckled.report.explanation, testing::Not(testing::HasSubstr("rounding")));
}

TEST(Statics, PrescribedDisplacementsAreReachedAndPulledBy) {
    // nu = 0.3, the ends sliding: uniaxial tension without any force given.
    runtime::Scene scene = box({4, 2, 2}, {1, 0.5, 0.5});
    for (std::size_t node = 0; node < scene.mesh.nodes().size(); ++node) {
        const Point& p = scene.mesh.nodes()[node];
        const auto n = static_cast<std::int32_t>(node);
        if (p[0] == 0) scene.prescribed.push_back({n, 0, [](double) { return 0.0; }});
        if (p[0] == 1) scene.prescribed.push_back({n, 0, [](double) { return 0.01; }});
        if (p[1] == 0) scene.prescribed.push_back({n, 1, [](double) { return 0.0; }});
        if (p[2] == 0) scene.prescribed.push_back({n, 2, [](double) { return 0.0; }});
    }
    for (const auto preconditioner : {runtime::PreconditionerKind::none, runtime::PreconditionerKind::block_jacobi,
                                      runtime::PreconditionerKind::coarse}) {
        for (const auto matrix : {runtime::OperatorKind::matrix_free, runtime::OperatorKind::edge_blocks,
                                  runtime::OperatorKind::block_rows}) {
            SCOPED_TRACE(std::string(to_string(preconditioner)) + " " + std::string(to_string(matrix)));
            runtime::EquilibriumSettings settings;
            settings.model = ElementModel::linear;
            settings.preconditioner = preconditioner;
            settings.matrix = matrix;
            const Found found = find(scene, settings);
            ASSERT_EQ(found.report.end, EquilibriumEnd::converged) << found.report.explanation;
            for (std::size_t node = 0; node < found.positions.size(); ++node) {
                const Point& p = scene.mesh.nodes()[node];
                EXPECT_NEAR(found.positions[node][0], 1.01 * p[0], 1e-9);
                EXPECT_NEAR(found.positions[node][1], (1 - 0.3 * 0.01) * p[1], 1e-9);
                EXPECT_NEAR(found.positions[node][2], (1 - 0.3 * 0.01) * p[2], 1e-9);
            }
            EXPECT_NEAR(found.report.elastic_energy, 0.5 * young * 0.01 * 0.01 * 0.25, 1e-9);
        }
    }
}

TEST(Statics, FloatingComponentsAreNamed) {
    // Two boxes side by side, of which one is clamped.
    const mesh::TetMesh first = mesh::box({.cells = {1, 1, 1}}),
                        second = mesh::box({.cells = {2, 1, 1}, .origin = {3, 0, 0}});
    mesh::TetMesh::Definition definition = first.definition();
    const auto shift = static_cast<std::int32_t>(definition.nodes.size());
    definition.nodes.insert(definition.nodes.end(), second.nodes().begin(), second.nodes().end());
    for (mesh::Tetrahedron t : second.tetrahedra()) {
        for (std::int32_t& node : t) node += shift;
        definition.tetrahedra.push_back(t);
    }
    definition.regions.clear();
    runtime::Scene scene;
    scene.mesh = mesh::TetMesh(definition);
    scene.gravity = {0, 0, 0};
    for (std::int32_t node = 0; node < shift; ++node) {
        if (scene.mesh.nodes()[static_cast<std::size_t>(node)][0] == 0) scene.fixed_nodes.push_back(node);
    }
    scene.nodal_loads = {{shift, {0, 0, 1}}};
    const auto floating = floating_components(scene);
    ASSERT_EQ(floating.size(), 1U);
    EXPECT_EQ(floating[0].component, 1);
    EXPECT_EQ(floating[0].nodes, 12);
    EXPECT_EQ(floating[0].first_node, shift);
    EXPECT_EQ(floating[0].free_motions, 6);
    const std::string message = refusal([&] { find(scene, {}); });
    EXPECT_THAT(message, testing::HasSubstr("component 1, with 12 nodes from node 8, has 6 free motions"));

    runtime::EquilibriumSettings settings;
    settings.hold_floating = true;
    const Found found = find(scene, settings);
    EXPECT_EQ(found.report.end, EquilibriumEnd::converged) << found.report.explanation;
    EXPECT_EQ(found.report.held_components, 1);

    // A body on one hinge turns about it.
    scene.prescribed = {{shift, 0, [](double) { return 0.0; }},
                        {shift, 1, [](double) { return 0.0; }},
                        {shift, 2, [](double) { return 0.0; }}};
    EXPECT_EQ(floating_components(scene).at(0).free_motions, 3);
    EXPECT_THAT(refusal([&] { find(scene, settings); }), testing::HasSubstr("held in part, with 3 free motions"));
}

TEST(Statics, BadInputIsRefusedWithTheReason) {
    runtime::Scene scene = box({2, 1, 1}, {1, 1, 1});
    clamp(scene, "x_min");
    const auto expect_refusal = [&](const std::function<void(runtime::Scene&, runtime::EquilibriumSettings&)>& spoil,
                                    const std::string& part) {
        runtime::Scene spoiled = scene;
        runtime::EquilibriumSettings settings;
        spoil(spoiled, settings);
        EXPECT_THAT(refusal([&] { find(spoiled, settings); }), testing::HasSubstr(part));
    };
    const auto zero = [](double) { return 0.0; };
    expect_refusal([&](auto& s, auto&) { s.nodal_loads = {{99, {0, 0, 1}}}; }, "nodal load 0: node 99 does not exist");
    expect_refusal(
        [&](auto& s, auto&) {
            s.nodal_loads = {{1, {0, NAN, 1}}};
        },
        "nodal load 0: the force is not finite");
    expect_refusal(
        [&](auto& s, auto&) {
            s.edge_loads = {{{1, 1}, {0, 0, 1}}};
        },
        "edge load 0: the edge has no length");
    expect_refusal(
        [&](auto& s, auto&) {
            s.tractions = {{{{0, 1, 1}}, {0, 0, 1}}};
        },
        "traction 0: triangle 0, 1, 1 has no area");
    expect_refusal(
        [&](auto& s, auto&) {
            s.prescribed = {{1, 3, zero}};
        },
        "axis 3: expected a node of the mesh, axis 0, 1 or 2");
    expect_refusal([&](auto& s, auto&) { s.prescribed = {{1, 0, zero}, {1, 0, zero}}; }, "given twice");
    expect_refusal([&](auto& s, auto&) { s.fixed_nodes = {-1}; }, "fixed node -1");
    expect_refusal([](auto& s, auto&) { s.floor = {{0, 0, 0}, {0, 0, 1}}; }, "has a floor");
    expect_refusal([](auto&, auto& t) { t.tolerance = 0; }, "the tolerance must be in (0, 1)");
    expect_refusal([](auto&, auto& t) { t.load_steps = 0; }, "at least one load step");
    expect_refusal(
        [](auto&, auto& t) {
            t.model = ElementModel::st_venant_kirchhoff;
            t.tangent = runtime::TangentKind::rotated;
        },
        "rotated");
}

TEST(Statics, EveryLumpingOfWholeLinearTetrahedraIsTheirRowSum) {
    const runtime::Scene scene = box({3, 2, 2}, {1, 2, 3});
    const auto numbering = runtime::number_scene(scene, mesh::OrderingKind::none, {});
    const auto materials = element_materials(scene);
    const auto rows = nodal_masses(scene, materials, numbering, runtime::MassKind::lumped);
    const auto weighted = nodal_masses(scene, materials, numbering, runtime::MassKind::weighted_diagonal);
    const auto fraction = nodal_masses(scene, materials, numbering, runtime::MassKind::fraction);
    double total = 0;
    for (std::size_t node = 0; node < rows.size(); ++node) {
        EXPECT_NEAR(weighted[node], rows[node], 1e-12);
        EXPECT_NEAR(fraction[node], rows[node], 1e-12);
        total += weighted[node];
    }
    EXPECT_NEAR(total, 6000, 1e-9);  // 1000 kg / m^3
}

TEST(Statics, LoadsOnEdgesAndFacesAreTheirSums) {
    runtime::Scene scene = box({2, 2, 2}, {1, 2, 3});
    const mesh::Boundary boundary = mesh::boundary(scene.mesh);
    scene.tractions = {
        {runtime::triangles_where(scene.mesh, boundary.triangles, [](const Point& p) { return p[0] == 1; }),
         {1, 2, 3}}};
    scene.edge_loads = {{{0, 1}, {4, 0, 0}}};
    scene.nodal_loads = {{5, {0, 0, 7}}};
    Point total{};
    for (const Point& load : external_loads(scene)) {
        for (std::size_t axis = 0; axis < 3; ++axis) total[axis] += load[axis];
    }
    EXPECT_NEAR(total[0], 6 * 1 + 0.5 * 4, 1e-12);
    EXPECT_NEAR(total[1], 6 * 2, 1e-12);
    EXPECT_NEAR(total[2], 6 * 3 + 7, 1e-12);
}

}  // namespace
}  // namespace lancet::test
