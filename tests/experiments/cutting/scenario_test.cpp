// The bodies of the experiment and the cuts through them.
#include "lancet/experiments/cutting/scenario.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "lancet/experiments/common/organ_mesh.hpp"
#include "lancet/experiments/cutting/beam_reference.hpp"
#include "lancet/experiments/cutting/run.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/mesh/boundary.hpp"
#include "lancet/mesh/components.hpp"
#include "lancet/mesh/cut/part_geometry.hpp"
#include "lancet/mesh/generate/box.hpp"

namespace lancet::experiments::cutting {
namespace {

/// The area of the walls of cuts, and the volume that the whole surface encloses.
struct Surface {
    double wall = 0, enclosed = 0;
};

Surface surface_at_rest(const mesh::CutMesh& cut) {
    const mesh::PartGeometry geometry = part_geometry(cut);
    const std::vector<Point> x = place(geometry, cut, cut.rest_positions());
    Surface surface;
    for (std::size_t t = 0; t < geometry.triangles.size(); ++t) {
        const auto& [a, b, c] = geometry.triangles[t];
        if (geometry.is_wall[t] != 0) surface.wall += mesh::area(x[a], x[b], x[c]);
        surface.enclosed -= mesh::signed_volume(x[a], x[b], x[c], {3, -2, 5});
    }
    return surface;
}

TEST(CuttingScenario, TheOrganIsOneClosedBody) {
    const mesh::TetMesh organ = organ_mesh(8, 18);
    EXPECT_EQ(organ.tetrahedra().size(), 18U * 8 * 8 * 18);
    EXPECT_EQ(mesh::components(organ).count, 1);
    const mesh::Boundary boundary = mesh::boundary(organ);
    EXPECT_EQ(boundary.overused_faces, 0);
    double enclosed = 0;
    for (const auto& [a, b, c] : boundary.triangles) {
        enclosed -= mesh::signed_volume(organ.nodes()[a], organ.nodes()[b], organ.nodes()[c], {1, 2, 3});
    }
    // Cones to a place some 4 m away, of some thousand triangles: rounding of their sum, not of the volume.
    EXPECT_NEAR(enclosed, organ.volume(), 1e-14);
    const auto [low, high] = organ.bounds();
    EXPECT_NEAR(high[0] - low[0], 0.2, 0.02);
}

TEST(CuttingScenario, EveryScenarioCutsElementsAndSeparatesNothing) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    for (const Scenario& scenario : {dissected_beam(true), organ({}, true), scalpel(true, *scheduler)}) {
        SCOPED_TRACE(scenario.name);
        EXPECT_FALSE(scenario.scene.fixed_nodes.empty());
        mesh::CutMesh cut(scenario.scene.mesh);
        for (const Stroke& stroke : scenario.strokes) {
            EXPECT_LT(stroke.step, scenario.steps);
            cut.cut(stroke.surface, stroke.front);
        }
        EXPECT_GT(count_cut_elements(cut), 50);
        EXPECT_GT(cut.node_of_copy().size(), scenario.scene.mesh.nodes().size());
        EXPECT_EQ(mesh::components(cut.node_of_copy().size(), cut.parts()).count, 1);
        const Surface surface = surface_at_rest(cut);
        EXPECT_GT(surface.wall, 0);
        EXPECT_NEAR(surface.enclosed, scenario.scene.mesh.volume(), 1e-12 * (1 + scenario.scene.mesh.volume()));
        for (const int step : scenario.view.steps) EXPECT_LE(step, scenario.steps);
    }
}

/// A blade through a box on an arc, in so many strokes; at once or one by one.
mesh::CutMesh cut_on_arc(int strokes, bool is_at_once, double angle) {
    mesh::CutMesh cut(mesh::box({.cells = {7, 6, 3}, .size = {1.4, 1.2, 0.6}}));
    std::vector<std::array<Point, 2>> places;
    for (int k = 0; k <= strokes; ++k) {
        const double a = angle * k / strokes;
        places.push_back({Point{0.1 + 1.3 * std::sin(a), 1.4 * std::cos(a), -0.1},
                          Point{0.1 + 1.3 * std::sin(a), 1.4 * std::cos(a), 0.7}});
    }
    if (is_at_once) {
        cut.cut(mesh::CutSurface::swept(places));
        return cut;
    }
    for (int k = 0; k < strokes; ++k) {
        cut.cut(mesh::CutSurface::swept(std::span(places).subspan(static_cast<std::size_t>(k), 2)));
    }
    return cut;
}

TEST(CuttingScenario, StrokesOneByOneLeaveNoBridge) {
    for (const int strokes : {2, 5, 13}) {
        SCOPED_TRACE(strokes);
        // From above to the right, or to below the right end of the box: cut through.
        for (const double angle : {0.3, 0.5 * std::numbers::pi + 0.3}) {
            const mesh::CutMesh at_once = cut_on_arc(strokes, true, angle);
            const mesh::CutMesh one_by_one = cut_on_arc(strokes, false, angle);
            EXPECT_EQ(one_by_one.parts().size(), at_once.parts().size());
            EXPECT_EQ(one_by_one.node_of_copy().size(), at_once.node_of_copy().size());
            EXPECT_EQ(mesh::components(one_by_one.node_of_copy().size(), one_by_one.parts()).count,
                      mesh::components(at_once.node_of_copy().size(), at_once.parts()).count);
            const Surface expected = surface_at_rest(at_once), found = surface_at_rest(one_by_one);
            EXPECT_NEAR(found.wall, expected.wall, 1e-12);
            EXPECT_NEAR(found.enclosed, at_once.mesh().volume(), 1e-12);
        }
        EXPECT_EQ(mesh::components(cut_on_arc(strokes, false, 0.5 * std::numbers::pi + 0.3).node_of_copy().size(),
                                   cut_on_arc(strokes, false, 0.5 * std::numbers::pi + 0.3).parts())
                      .count,
                  2);
    }
}

TEST(CuttingScenario, AMissingOrganIsRefused) {
    EXPECT_THROW((void)organ(OrganFile{"no-such-organ.msh", {}}, true), Error);
    EXPECT_THROW((void)organ(OrganFile{"no-such-organ.msh", -1.0}, true), Error);
}

TEST(CuttingScenario, ReferencesOfTheBeamAreWhereTheBeamIs) {
    EXPECT_EQ(beam_references().size(), 6U);
    for (const BeamReference& reference : beam_references()) {
        // Held below, moved above: the displacement grows along the beam.
        const auto length = [&](std::size_t sample) {
            const Point u = reference.displacement(sample);
            return std::hypot(u[0], u[1], u[2]);
        };
        EXPECT_GT(length(BeamReference::samples - 1), 5 * length(0)) << reference.load;
        EXPECT_LT(length(BeamReference::samples - 1), 0.3) << reference.load;
    }
    EXPECT_EQ(BeamReference::place(BeamReference::samples - 1), (Point{0.027, 0.03, 0.195}));
}

}  // namespace
}  // namespace lancet::experiments::cutting
