// Cut beams whose discrete equations an independent code has solved to 12 digits, on equal meshes: a cut along the
// faces of elements (D1), a full oblique one with slivers of 8e-7 (D3), and one that ends within the body (D4).
#include <map>

#include "tests/verification/discrete_beam.hpp"
#include <gtest/gtest.h>

#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"
#include "lancet/runtime/cut/enrichment.hpp"
#include "lancet/runtime/simulate/equilibrium.hpp"

namespace lancet::test {
namespace {

using mesh::CutSurface;
using mesh::Point;
using runtime::ElementModel;
using runtime::ScalarMode;

struct CutCase {
    const char* name;
    const char* displacements;
    ElementModel model;
    double energy;  ///< J; 0 where the reference gives none
};

void PrintTo(const CutCase& cut, std::ostream* stream) {
    *stream << cut.name;
}

struct Solution {
    std::vector<Point> displacements;  ///< of all copies
    double energy;
};

Solution solve(const runtime::Scene& scene, ElementModel model, ScalarMode scalar, runtime::OperatorKind matrix) {
    const auto scheduler = runtime::make_scheduler(runtime::default_scheduler, 2);
    runtime::EquilibriumSettings settings;
    settings.model = model;
    settings.scalar = scalar;
    settings.matrix = matrix;
    settings.tolerance = 1e-10;
    std::vector<Point> positions(scene.mesh.nodes().begin(), scene.mesh.nodes().end());
    const auto report = find_equilibrium(scene, settings, *scheduler, positions);
    EXPECT_EQ(report.end, runtime::EquilibriumEnd::converged) << report.explanation;
    EXPECT_LE(report.residual, settings.tolerance);
    return {displacements(scene.mesh.nodes(), positions), report.elastic_energy};
}

constexpr std::array operators{runtime::OperatorKind::matrix_free, runtime::OperatorKind::edge_blocks,
                               runtime::OperatorKind::block_rows};

class CutAlongFaces : public ::testing::TestWithParam<CutCase> {};

INSTANTIATE_TEST_SUITE_P(
    D1, CutAlongFaces,
    ::testing::Values(CutCase{"linear", "D1_cut_aligned_linear.csv", ElementModel::linear, 0.0680647970285},
                      CutCase{"corotational", "D1_cut_aligned_corot.csv", ElementModel::corotational, 0.0568937677203},
                      CutCase{"svk", "D1_cut_aligned_svk.csv", ElementModel::st_venant_kirchhoff, 0}),
    [](const auto& instance) { return instance.param.name; });

// The reference has a mesh whose nodes are doubled along the cut; cutting the uncut mesh must double the same.
TEST_P(CutAlongFaces, EqualsTheMeshMadeWithTheCut) {
    const auto rows = read_numbers(reference_folder() / "discrete" / GetParam().displacements);
    if (rows.empty()) GTEST_SKIP() << "no reference displacements in " << reference_folder() / "discrete";
    const runtime::Scene scene = discrete_beam("uncut"), reference = discrete_beam("D1");
    mesh::CutMesh cut(scene.mesh);
    const auto report = cut.cut(CutSurface::half_plane({0.015, 0, 0.1}, {0, 0, 1}, {-1, 0, 0}));
    EXPECT_EQ(report.new_parts, 0);
    ASSERT_EQ(cut.node_of_copy().size(), reference.mesh.nodes().size());
    const Solution solution =
        solve(divided(scene, cut), GetParam().model, ScalarMode::double_precision, runtime::OperatorKind::edge_blocks);
    // Element e is the same in both meshes: its corners say which copy is which.
    std::vector<Point> found(rows.size()), expected(rows.size());
    for (std::size_t e = 0; e < cut.parts().size(); ++e) {
        for (std::size_t corner = 0; corner < 4; ++corner) {
            found[static_cast<std::size_t>(reference.mesh.tetrahedra()[e][corner])] =
                solution.displacements[static_cast<std::size_t>(cut.parts()[e][corner])];
        }
    }
    for (std::size_t node = 0; node < rows.size(); ++node)
        expected[node] = {rows[node][1], rows[node][2], rows[node][3]};
    EXPECT_LE(largest_difference(found, expected), 1e-9);
    if (GetParam().energy > 0) {
        EXPECT_NEAR(solution.energy, GetParam().energy, 1e-11);
    }
}

class CutThroughElements : public ::testing::TestWithParam<CutCase> {
  protected:
    static bool is_full(const CutCase& cut) { return std::string(cut.name).starts_with("D3"); }
};

INSTANTIATE_TEST_SUITE_P(
    Beams, CutThroughElements,
    ::testing::Values(
        CutCase{"D3_linear", "D3_xfem_full_linear.csv", ElementModel::linear, 0.00426076192282},
        CutCase{"D3_corotational", "D3_xfem_full_corot.csv", ElementModel::corotational, 0.00425186733644},
        CutCase{"D4_linear", "D4_xfem_partial_linear.csv", ElementModel::linear, 0.0662619910611},
        CutCase{"D4_corotational", "D4_xfem_partial_corot.csv", ElementModel::corotational, 0.0561322023584}),
    [](const auto& instance) { return instance.param.name; });

TEST_P(CutThroughElements, ShiftedEnrichmentAgreesToNineDigits) {
    const auto rows = read_numbers(reference_folder() / "discrete" / GetParam().displacements);
    if (rows.empty()) GTEST_SKIP() << "no reference displacements in " << reference_folder() / "discrete";
    runtime::Scene scene = discrete_beam("uncut");
    if (is_full(GetParam())) {
        for (const std::int32_t node : [&] {
                 std::vector<std::int32_t> far_end;
                 for (std::size_t n = 0; n < scene.mesh.nodes().size(); ++n) {
                     if (scene.mesh.nodes()[n][2] == scene.mesh.bounds()[1][2]) {
                         far_end.push_back(static_cast<std::int32_t>(n));
                     }
                 }
                 return far_end;
             }()) {
            scene.fixed_nodes.push_back(node);
        }
    }
    mesh::CutMesh cut(scene.mesh);
    cut.cut(is_full(GetParam()) ? CutSurface::plane({0, 0, 0.1137}, {0.31, 0.17, 1})
                                : CutSurface::half_plane({0.015, 0, 0.1037}, {0, 0, 1}, {-1, 0, 0}));
    const runtime::Scene parts = divided(scene, cut);
    std::vector<Point> expected_u, expected_a;
    for (const auto& row : rows) {
        expected_u.push_back({row[3], row[4], row[5]});
        if (row[2] == 1) expected_a.push_back({row[6], row[7], row[8]});
    }
    for (const ScalarMode scalar : {ScalarMode::double_precision, ScalarMode::mixed}) {
        for (const runtime::OperatorKind matrix : operators) {
            SCOPED_TRACE(std::string(to_string(scalar)) + ", " + std::string(to_string(matrix)));
            const Solution solution = solve(parts, GetParam().model, scalar, matrix);
            std::vector<Point> found_u, found_a;
            for (std::size_t node = 0; node < rows.size(); ++node) {
                const auto copies = cut.copies_of_node(static_cast<std::int32_t>(node));
                ASSERT_EQ(copies.size(), rows[node][2] == 1 ? 2U : 1U) << "node " << node;
                std::vector<Point> values;
                for (const std::int32_t copy : copies) {
                    values.push_back(solution.displacements[static_cast<std::size_t>(copy)]);
                }
                // Copy 0 is that of the node's own side.
                std::vector<runtime::CopyLevel> levels;
                if (copies.size() == 2) levels.push_back({0, static_cast<int>(rows[node][1])});
                copies_to_enriched(runtime::Enrichment::shifted, levels, values);
                found_u.push_back(values[0]);
                if (copies.size() == 2) found_a.push_back(values[1]);
            }
            EXPECT_LE(largest_difference(found_u, expected_u), 1e-9);
            EXPECT_LE(largest_difference(found_a, expected_a), 1e-9);
            EXPECT_NEAR(solution.energy, GetParam().energy, 1e-11);
        }
    }
}

}  // namespace
}  // namespace lancet::test
