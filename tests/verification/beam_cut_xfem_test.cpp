// The beam of Schoch et al. 2013, section 6.1, cut half through along a plane that runs through the elements, beside
// the same beam on meshes whose faces follow the cut. The front of the cut, where displacements grow like the square
// root of the distance, limits both to order 1 in the energy.
#include <algorithm>
#include <cmath>

#include "tests/verification/beam_cut.hpp"
#include "tests/verification/reference_table.hpp"
#include <gtest/gtest.h>

#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"

namespace lancet::test {
namespace {

struct Errors {
    double energy;  ///< relative
    double l2;      ///< of the displacement at the sample points, relative
    double unknowns;
};

/// A point of the material of a box mesh by its place at rest; the elements of a cell follow each other.
mesh::MaterialPoint locate(const mesh::CutMesh& cut, const std::array<int, 3>& cells, const Point& place) {
    constexpr std::array<double, 3> size{0.03, 0.06, 0.2};
    std::array<int, 3> cell{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        cell[axis] = std::clamp(static_cast<int>(place[axis] / size[axis] * cells[axis]), 0, cells[axis] - 1);
    }
    const int first = 5 * (cell[0] + cells[0] * (cell[1] + cells[1] * cell[2]));
    const auto nodes = cut.mesh().nodes();
    mesh::MaterialPoint best;
    double depth = -1e300;
    for (int e = first; e < first + 5; ++e) {
        const mesh::Tetrahedron& t = cut.mesh().tetrahedra()[static_cast<std::size_t>(e)];
        const mesh::Barycentric weights =
            mesh::barycentric({nodes[t[0]], nodes[t[1]], nodes[t[2]], nodes[t[3]]}, place);
        const double lowest = std::ranges::min(weights);
        if (lowest <= depth) continue;
        depth = lowest;
        best = cut.material_point(e, weights);
    }
    return best;
}

enum class Mesh { aligned, through_elements };
using mesh::Fronts;

Errors solve(const BeamCase& beam, int refinement, Mesh kind, Fronts fronts,
             std::span<const std::vector<double>> samples) {
    // One more layer puts the plane z = 0.1 into the middle of a layer; the front stays on faces.
    const std::array<int, 3> cells{4 * refinement, 8 * refinement,
                                   26 * refinement + (kind == Mesh::through_elements ? 1 : 0)};
    const runtime::Scene scene =
        loaded_beam(beam, mesh::box({.cells = cells, .size = {0.03, 0.06, 0.2}, .swap_parity = true}));
    mesh::CutMesh cut(scene.mesh);
    // Where nodes are meant to lie on the plane or on its border, their rounded places decide.
    Point border{0.015, 0, 0.1};
    for (const Point& node : scene.mesh.nodes()) {
        if (is_near(node[0], 0.015)) border[0] = node[0];
        if (is_near(node[2], 0.1)) border[2] = node[2];
    }
    cut.cut(mesh::CutSurface::half_plane(border, {0, 0, 1}, {-1, 0, 0}));
    const runtime::Scene parts = divided(scene, cut, fronts);
    runtime::EquilibriumSettings settings;
    settings.model = beam.model;
    settings.tolerance = 1e-8;
    const auto scheduler = runtime::make_scheduler(runtime::default_scheduler, 2);
    const std::span<const Point> rest = parts.mesh.nodes();
    std::vector<Point> positions(rest.begin(), rest.end());
    const auto report = find_equilibrium(parts, settings, *scheduler, positions);
    EXPECT_EQ(report.end, runtime::EquilibriumEnd::converged) << report.explanation;

    double difference = 0, norm = 0;
    for (const auto& row : samples) {
        if (row[4] != 0 || row.size() < 11) continue;  // pairs on the lips are known by their side alone
        const mesh::MaterialPoint at = locate(cut, cells, {row[1], row[2], row[3]});
        for (std::size_t axis = 0; axis < 3; ++axis) {
            double displacement = 0;
            for (std::size_t k = 0; k < 4; ++k) {
                const auto copy = static_cast<std::size_t>(cut.parts()[static_cast<std::size_t>(at.part)][k]);
                displacement += at.weights[k] * (positions[copy][axis] - rest[copy][axis]);
            }
            difference += std::pow(displacement - row[8 + axis], 2);
            norm += row[8 + axis] * row[8 + axis];
        }
    }
    return {std::abs(report.elastic_energy / beam.energy - 1), std::sqrt(difference / norm),
            3.0 * static_cast<double>(rest.size())};
}

class BeamCutXfem : public ::testing::TestWithParam<BeamCase> {};
INSTANTIATE_TEST_SUITE_P(Schoch, BeamCutXfem, ::testing::ValuesIn(beam_cases),
                         [](const auto& instance) { return instance.param.name; });

TEST_P(BeamCutXfem, ConvergesBesideAlignedMeshes) {
    const BeamCase& beam = GetParam();
    const std::string model = beam.model == ElementModel::linear         ? "linear"
                              : beam.model == ElementModel::corotational ? "corot"
                                                                         : "svk";
    const std::string load = beam.load == 1 ? "1" : std::to_string(beam.load) + "T";
    const auto samples = read_numbers(reference_folder() / "beam-cut" / ("samples_case" + load + "_" + model + ".csv"));
    if (samples.empty()) GTEST_SKIP() << "no reference in " << reference_folder() / "beam-cut";
    std::array<Errors, 3> aligned{}, sharp{}, blended{};
    for (std::size_t level = 0; level < 3; ++level) {
        aligned[level] = solve(beam, 1 << level, Mesh::aligned, Fronts::sharp, samples);
        sharp[level] = solve(beam, 1 << level, Mesh::through_elements, Fronts::sharp, samples);
        blended[level] = solve(beam, 1 << level, Mesh::through_elements, Fronts::blended, samples);
    }
    const auto order = [](const std::array<Errors, 3>& errors, double Errors::*value) {
        // Unknowns grow with the third power of the cells.
        return -3 * std::log(errors[2].*value / (errors[1].*value)) / std::log(errors[2].unknowns / errors[1].unknowns);
    };
    const auto report = [&](const char* name, const std::array<Errors, 3>& errors) {
        std::printf("    %-16s", name);
        for (const Errors& level : errors) {
            std::printf(" %7.0f unknowns: energy %6.3f %%, L2 %6.3f %%;", level.unknowns, 100 * level.energy,
                        100 * level.l2);
        }
        std::printf(" orders %.2f, %.2f\n", order(errors, &Errors::energy), order(errors, &Errors::l2));
    };
    report("aligned", aligned);
    report("sharp front", sharp);
    report("blended front", blended);
    // Between aligned meshes and those lie the half layer by which the cut's surroundings are less well resolved, and
    // 1.4 % of the unknowns.
    EXPECT_NEAR(order(sharp, &Errors::l2), order(aligned, &Errors::l2), 0.1);
    EXPECT_NEAR(order(sharp, &Errors::energy), order(aligned, &Errors::energy), 0.1);
    EXPECT_LT(sharp[2].l2, 1.22 * aligned[2].l2);
    EXPECT_GT(order(blended, &Errors::l2), 0.9);
    EXPECT_LT(blended[2].l2, aligned[2].l2);
}

}  // namespace
}  // namespace lancet::test
