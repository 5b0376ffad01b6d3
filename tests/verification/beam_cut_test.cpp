// The beam of Schoch et al. 2013, section 6.1, cut half through along element faces (D1 and its refinements), against
// the extrapolated solution of 20-node hexahedra. At the front of the cut displacements grow like the square root of
// the distance, so that linear elements converge in first order there, whatever the measure.
#include <cmath>
#include <map>

#include "tests/verification/convergence.hpp"
#include <gtest/gtest.h>

#include "lancet/mesh/boundary.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/simulate/equilibrium.hpp"

namespace lancet::test {
namespace {

using mesh::Point;
using runtime::ElementModel;

/// shared/reference/beam-cut/convergence.csv, columns 'extrap': energy in J, the middle of the top, the opening of the
/// lips in the middle of the width; about four digits for case 1, three to four for the others.
struct BeamCase {
    const char* name;
    int load;  ///< 1: gravity; 2, 3: tractions 2T, 3T
    ElementModel model;
    double energy, top_x, top_z, lip;
    double digits;
};

void PrintTo(const BeamCase& beam, std::ostream* stream) {
    *stream << beam.name;
}

struct Answer {
    double energy, top_x, top_z, lip;
};

bool is_near(double a, double b) {
    return std::abs(a - b) < 1e-9;
}

/// The box with the nodes of the cut z = 0.1, x < 0.015 doubled: those above it belong to the upper elements.
runtime::Scene cut_beam(int refinement, std::int32_t& first_upper_node) {
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
    runtime::Scene scene;
    scene.mesh = mesh::TetMesh(std::move(definition));
    for (std::size_t node = 0; node < scene.mesh.nodes().size(); ++node) {
        if (scene.mesh.nodes()[node][2] == 0) scene.fixed_nodes.push_back(static_cast<std::int32_t>(node));
    }
    scene.materials = {{0, {.young_modulus = 3e5, .poisson_ratio = 0.35, .density = 1070}}};
    return scene;
}

/// A total force, uniform over the strip of the top face between two x.
runtime::Traction pull(const mesh::TetMesh& mesh, double from, double to, const Point& force) {
    const double area = 0.0075 * 0.06;
    const mesh::Boundary boundary = mesh::boundary(mesh);
    return {runtime::triangles_where(
                mesh, boundary.triangles,
                [&](const Point& p) { return is_near(p[2], 0.2) && p[0] > from - 1e-9 && p[0] < to + 1e-9; }),
            {force[0] / area, force[1] / area, force[2] / area}};
}

Answer solve(const BeamCase& beam, int refinement) {
    std::int32_t first_upper = 0;
    runtime::Scene scene = cut_beam(refinement, first_upper);
    scene.gravity = {beam.load == 1 ? 9.81 : 0, 0, 0};
    if (beam.load == 2) scene.tractions.push_back(pull(scene.mesh, 0, 0.0075, {0, 0, 20}));
    if (beam.load == 3) {
        scene.tractions.push_back(pull(scene.mesh, 0, 0.0075, {0, 0, 10}));
        scene.tractions.push_back(pull(scene.mesh, 0.0225, 0.03, {-1, 0, -10}));
    }
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
INSTANTIATE_TEST_SUITE_P(Schoch, BeamCut,
                         ::testing::Values(BeamCase{"case1_linear", 1, ElementModel::linear, 0.081196249, 0.11492654,
                                                    0.0017825133, 0.0060509805, 2e-4},
                                           BeamCase{"case1_corotational", 1, ElementModel::corotational, 0.063019124,
                                                    0.09399372, -0.026865744, 0.0040345737, 2e-4},
                                           BeamCase{"case1_svk", 1, ElementModel::st_venant_kirchhoff, 0.063175117,
                                                    0.094101713, -0.027312785, 0.0039641131, 2e-4},
                                           BeamCase{"case2T_linear", 2, ElementModel::linear, 0.37611089, 0.20027695,
                                                    0.014265813, 0.02435135, 1e-3},
                                           BeamCase{"case2T_corotational", 2, ElementModel::corotational, 0.099737659,
                                                    0.011655419, 0.0075486473, 0.0053715471, 1e-3},
                                           BeamCase{"case2T_svk", 2, ElementModel::st_venant_kirchhoff, 0.090833058,
                                                    0.0117064, 0.0070504487, 0.0050323654, 1e-3},
                                           BeamCase{"case3T_linear", 3, ElementModel::linear, 0.066121349, 0.073548309,
                                                    0.0023561915, 0.0080103805, 1e-3},
                                           BeamCase{"case3T_corotational", 3, ElementModel::corotational, 0.049926525,
                                                    0.052969691, -0.01179905, 0.0057714733, 1e-3},
                                           BeamCase{"case3T_svk", 3, ElementModel::st_venant_kirchhoff, 0.050251952,
                                                    0.052808145, -0.012042214, 0.0056808588, 1e-3}),
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
