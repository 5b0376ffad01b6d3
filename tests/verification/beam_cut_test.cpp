// The beam of Schoch et al. 2013, section 6.1, cut half through along element faces (D1 and its refinements), against
// the extrapolated solution of 20-node hexahedra. At the front of the cut displacements grow like the square root of
// the distance, so that linear elements converge in first order there, whatever the measure.
#include "tests/verification/beam_cut.hpp"

#include <cmath>
#include <map>

#include "tests/verification/convergence.hpp"
#include <gtest/gtest.h>

#include "lancet/mesh/generate/box.hpp"

namespace lancet::test {
namespace {

struct Answer {
    double energy, top_x, top_z, lip;
};

/// The box with the nodes of the cut z = 0.1, x < 0.015 doubled: those above it belong to the upper elements.
mesh::TetMesh cut_beam(int refinement, std::int32_t& first_upper_node) {
    const mesh::TetMesh box = mesh::box(
        {.cells = {4 * refinement, 8 * refinement, 26 * refinement}, .size = {0.03, 0.06, 0.2}, .swap_parity = true});
    mesh::TetMesh::Definition definition = box.definition();
    definition.node_sets.clear();
    first_upper_node = static_cast<std::int32_t>(definition.nodes.size());
    std::map<std::int32_t, std::int32_t> upper;
    for (std::int32_t node = 0; node < first_upper_node; ++node) {
        const Point p = definition.nodes[static_cast<std::size_t>(node)];
        if (!is_near(p[2], 0.1) || p[0] > 0.015 - 1e-9) continue;
        upper[node] = static_cast<std::int32_t>(definition.nodes.size());
        definition.nodes.push_back(p);
    }
    for (mesh::Tetrahedron& tetrahedron : definition.tetrahedra) {
        double height = 0;
        for (const std::int32_t node : tetrahedron) height += definition.nodes[static_cast<std::size_t>(node)][2] / 4;
        if (height < 0.1) continue;
        for (std::int32_t& node : tetrahedron) {
            if (const auto found = upper.find(node); found != upper.end()) node = found->second;
        }
    }
    return mesh::TetMesh(std::move(definition));
}

Answer solve(const BeamCase& beam, int refinement) {
    std::int32_t first_upper = 0;
    const runtime::Scene scene = loaded_beam(beam, cut_beam(refinement, first_upper));
    runtime::EquilibriumSettings settings;
    settings.model = beam.model;
    settings.tolerance = 1e-8;
    const auto scheduler = runtime::make_scheduler(runtime::default_scheduler, 2);
    const std::span<const Point> rest = scene.mesh.nodes();
    std::vector<Point> positions(rest.begin(), rest.end());
    const auto report = find_equilibrium(scene, settings, *scheduler, positions);
    EXPECT_EQ(report.end, runtime::EquilibriumEnd::converged) << report.explanation;

    Answer answer{report.elastic_energy, 0, 0, 0};
    for (std::size_t node = 0; node < rest.size(); ++node) {
        const Point &p = rest[node], &x = positions[node];
        if (!is_near(p[1], 0.03)) continue;
        if (is_near(p[0], 0.015) && is_near(p[2], 0.2)) {
            answer.top_x = x[0] - p[0];
            answer.top_z = x[2] - p[2];
        }
        if (p[0] == 0 && is_near(p[2], 0.1)) answer.lip += node < static_cast<std::size_t>(first_upper) ? -x[2] : x[2];
    }
    return answer;
}

class BeamCut : public ::testing::TestWithParam<BeamCase> {};
INSTANTIATE_TEST_SUITE_P(Schoch, BeamCut, ::testing::ValuesIn(beam_cases),
                         [](const auto& instance) { return instance.param.name; });

TEST_P(BeamCut, ConvergesToTheExtrapolatedReference) {
    const BeamCase& beam = GetParam();
    const std::array<Answer, 3> on{solve(beam, 1), solve(beam, 2), solve(beam, 4)};
    const auto along = [&](double Answer::*value) { return Convergence{{on[0].*value, on[1].*value, on[2].*value}}; };
    expect_converges_to("energy", along(&Answer::energy), beam.energy, beam.digits);
    expect_converges_to("top_x", along(&Answer::top_x), beam.top_x, beam.digits);
    expect_converges_to("top_z", along(&Answer::top_z), beam.top_z, beam.digits);
    expect_converges_to("lip", along(&Answer::lip), beam.lip, beam.digits);
    // The energy of a singularity of order 1/2 converges in order 1, which these meshes approach from either side.
    EXPECT_GT(along(&Answer::energy).order(), 0.75);
    EXPECT_LT(along(&Answer::energy).order(), 2.1);
}

}  // namespace
}  // namespace lancet::test
