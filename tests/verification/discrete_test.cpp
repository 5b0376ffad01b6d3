// Nodal displacements of discrete problems, linear tetrahedra on equal meshes, against an independent code (12 digits).
#include <algorithm>
#include <cmath>

#include "tests/verification/discrete_beam.hpp"
#include <gtest/gtest.h>

#include "lancet/runtime/simulate/equilibrium.hpp"

namespace lancet::test {
namespace {

using mesh::Point;
using runtime::ElementModel;
using runtime::ScalarMode;

struct DiscreteCase {
    const char* name;
    const char* mesh;
    const char* displacements;
    ElementModel model;
    double energy;  ///< J; 0 where the reference gives none
};

void PrintTo(const DiscreteCase& discrete, std::ostream* stream) {
    *stream << discrete.name;
}

class Discrete : public ::testing::TestWithParam<DiscreteCase> {
  protected:
    static std::vector<Point> displacements_of(const DiscreteCase& discrete) {
        std::vector<Point> displacements;
        for (const auto& row : read_numbers(reference_folder() / "discrete" / discrete.displacements)) {
            displacements.push_back({row[1], row[2], row[3]});
        }
        return displacements;
    }

    /// The largest difference from the displacements of the reference, against the largest of them.
    static double difference(std::span<const Point> rest, std::span<const Point> positions,
                             std::span<const Point> expected) {
        return largest_difference(displacements(rest, positions), expected);
    }
};

INSTANTIATE_TEST_SUITE_P(
    Beams, Discrete,
    ::testing::Values(
        DiscreteCase{"D1_linear", "D1", "D1_cut_aligned_linear.csv", ElementModel::linear, 0.0680647970285},
        DiscreteCase{"D1_corotational", "D1", "D1_cut_aligned_corot.csv", ElementModel::corotational, 0.0568937677203},
        DiscreteCase{"D1_svk", "D1", "D1_cut_aligned_svk.csv", ElementModel::st_venant_kirchhoff, 0},
        DiscreteCase{"D2_svk", "uncut", "D2_uncut_svk.csv", ElementModel::st_venant_kirchhoff, 0},
        DiscreteCase{"D2_linear", "uncut", "D2_uncut_linear.csv", ElementModel::linear, 0.0620093811079},
        DiscreteCase{"D2_corotational", "uncut", "D2_uncut_corot.csv", ElementModel::corotational, 0.0536467723732}),
    [](const auto& instance) { return instance.param.name; });

TEST_P(Discrete, DisplacementsAgreeToNineDigits) {
    const std::vector<Point> expected = displacements_of(GetParam());
    if (expected.empty()) GTEST_SKIP() << "no reference displacements in " << reference_folder() / "discrete";
    const runtime::Scene scene = discrete_beam(GetParam().mesh);
    ASSERT_EQ(expected.size(), scene.mesh.nodes().size());
    const auto scheduler = runtime::make_scheduler(runtime::default_scheduler, 2);
    for (const ScalarMode scalar : {ScalarMode::double_precision, ScalarMode::mixed}) {
        SCOPED_TRACE(to_string(scalar));
        runtime::EquilibriumSettings settings;
        settings.model = GetParam().model;
        settings.scalar = scalar;
        settings.tolerance = 1e-10;
        std::vector<Point> positions(scene.mesh.nodes().begin(), scene.mesh.nodes().end());
        const auto report = find_equilibrium(scene, settings, *scheduler, positions);
        EXPECT_EQ(report.end, runtime::EquilibriumEnd::converged) << report.explanation;
        EXPECT_LE(report.residual, settings.tolerance);
        EXPECT_LE(difference(scene.mesh.nodes(), positions, expected), 1e-9);
        if (GetParam().energy > 0) {
            EXPECT_NEAR(report.elastic_energy, GetParam().energy, 1e-11);
        }
        RecordProperty(std::string(to_string(scalar)) + "_newton", report.newton_iterations);
        RecordProperty(std::string(to_string(scalar)) + "_cg", report.conjugate_gradient_iterations);
    }
}

// In float the strains are rounded to 1e-7, which the beam's slenderness amplifies: the answer says how far it came.
TEST_P(Discrete, FloatSaysHowFarItCame) {
    const std::vector<Point> expected = displacements_of(GetParam());
    if (expected.empty()) GTEST_SKIP() << "no reference displacements in " << reference_folder() / "discrete";
    const runtime::Scene scene = discrete_beam(GetParam().mesh);
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    runtime::EquilibriumSettings settings;
    settings.model = GetParam().model;
    settings.scalar = ScalarMode::single_precision;
    std::vector<Point> positions(scene.mesh.nodes().begin(), scene.mesh.nodes().end());
    const auto report = find_equilibrium(scene, settings, *scheduler, positions);
    EXPECT_EQ(report.end, runtime::EquilibriumEnd::stagnated) << report.explanation;
    EXPECT_GT(report.residual, settings.tolerance);
    // An element's strain is rounded to epsilon, its force to epsilon E h^2; some 24 of them meet in each node.
    const double nodes = static_cast<double>(scene.mesh.nodes().size()), weight = 1070 * 9.81 * 0.03 * 0.06 * 0.2;
    const double rounding = 0x1p-24 * 3e5 * 0.0075 * 0.0075 * std::sqrt(24 * 3 * nodes);
    EXPECT_LT(report.residual, rounding / (weight / std::sqrt(nodes)));
    EXPECT_EQ(report.load_factor, 1);
    EXPECT_LE(difference(scene.mesh.nodes(), positions, expected), 1e-3);
}

}  // namespace
}  // namespace lancet::test
