// Cracks in bodies so large that they hardly notice: the energy released by a penny-shaped crack and by Griffith's,
// against the closed formulas (shared/reference/standards/analytic.csv). E = 1, nu = 0.3, tension 1, crack radius or
// half length a = 1.
#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "lancet/mesh/boundary.hpp"
#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"
#include "lancet/runtime/simulate/equilibrium.hpp"
#include "lancet/runtime/simulate/loads.hpp"

namespace lancet::test {
namespace {

using mesh::Point;

constexpr double far = 8;          ///< half the size of the body
constexpr double thickness = 0.5;  ///< of the slice of Griffith's crack

/// From 0 to 1 onto 0 to `far`: even up to 2, where the crack is, then growing.
double graded(double s) {
    constexpr double even = 0.6;
    if (std::abs(s) >= 1) return std::copysign(far, s);
    const double a = std::abs(s), beyond = std::max(0.0, a - even);
    return std::copysign(2 * a / even + (far - 2 / even) * std::pow(beyond / (1 - even), 2), s);
}

enum class Crack { penny, griffith };

/// A quarter of the body, x and y > 0; of Griffith's crack the half x > 0 of a slice that cannot contract. The crack at
/// z = 0 runs through the middle of a layer of elements.
runtime::Scene body(Crack crack, int cells) {
    const bool is_penny = crack == Crack::penny;
    auto definition =
        mesh::box({.cells = {cells, is_penny ? cells : 1, 2 * cells + 1}, .size = {1, 1, 2}, .origin = {0, 0, -1}})
            .definition();
    definition.node_sets.clear();
    for (Point& node : definition.nodes) {
        node = {graded(node[0]), is_penny ? graded(node[1]) : thickness * node[1], graded(node[2])};
    }
    runtime::Scene scene;
    scene.mesh = mesh::TetMesh(std::move(definition));
    scene.gravity = {0, 0, 0};
    scene.materials = {{0, {.young_modulus = 1, .poisson_ratio = 0.3, .density = 1}}};
    const auto nodes = scene.mesh.nodes();
    const auto none = [](double) { return 0.0; };
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const auto node = static_cast<std::int32_t>(n);
        if (nodes[n][0] == 0) scene.prescribed.push_back({node, 0, none});
        if (nodes[n][1] == 0 || (!is_penny && nodes[n][1] == thickness)) scene.prescribed.push_back({node, 1, none});
        if (nodes[n][2] == -far) scene.prescribed.push_back({node, 2, none});
    }
    scene.tractions.push_back({runtime::triangles_where(scene.mesh, mesh::boundary(scene.mesh).triangles,
                                                        [](const Point& p) { return p[2] == far; }),
                               {0, 0, 1}});
    return scene;
}

mesh::CutSurface surface(Crack crack) {
    if (crack == Crack::griffith) return mesh::CutSurface::parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 3, 0});
    // A fan whose chords have, on the mean of the squares, radius 1.
    std::vector<Point> vertices{{-0.05, -0.05, 0}};
    std::vector<mesh::Triangle> triangles;
    constexpr int chords = 64;
    constexpr double from = -0.1, to = std::numbers::pi / 2 + 0.1, angle = (to - from) / chords;
    const double radius = std::sqrt(angle / std::sin(angle));
    for (int k = 0; k <= chords; ++k) {
        vertices.push_back({radius * std::cos(from + k * angle), radius * std::sin(from + k * angle), 0});
        if (k > 0) triangles.push_back({0, k, k + 1});
    }
    return mesh::CutSurface::triangulated(vertices, triangles);
}

double elastic_energy(const runtime::Scene& scene) {
    const auto scheduler = runtime::make_scheduler(runtime::default_scheduler, 2);
    runtime::EquilibriumSettings settings;
    settings.model = runtime::ElementModel::linear;
    settings.tolerance = 1e-8;
    std::vector<Point> positions(scene.mesh.nodes().begin(), scene.mesh.nodes().end());
    const auto report = find_equilibrium(scene, settings, *scheduler, positions);
    EXPECT_EQ(report.end, runtime::EquilibriumEnd::converged) << report.explanation;
    return report.elastic_energy;
}

/// Under dead loads the energy that a crack releases is what the elastic energy grows by.
double released(Crack crack, int cells) {
    const runtime::Scene scene = body(crack, cells);
    mesh::CutMesh cut(scene.mesh);
    cut.cut(surface(crack));
    return elastic_energy(divided(scene, cut, mesh::Fronts::blended)) - elastic_energy(scene);
}

/// Linear elements resolve the square root at the front in order 1. Two extrapolations, from a coarser and a finer pair
/// of meshes, say how good the second one is.
void expect_extrapolated(Crack crack, const std::array<int, 3>& cells, double exact, double finite_size) {
    std::array<double, 3> value{};
    for (std::size_t k = 0; k < 3; ++k) value[k] = released(crack, cells[k]);
    const auto limit = [&](std::size_t coarse, std::size_t fine) {
        const double ratio = static_cast<double>(cells[fine]) / cells[coarse];
        return value[fine] + (value[fine] - value[coarse]) / (ratio - 1);
    };
    const double first = limit(0, 1), second = limit(1, 2);
    std::printf("    released %.4f, %.4f, %.4f; in the limit %.4f, then %.4f; exact %.4f, off by %.1f %%\n", value[0],
                value[1], value[2], first, second, exact, 100 * (second / exact - 1));
    EXPECT_LT(std::abs(value[2] - exact), std::abs(value[1] - exact));
    EXPECT_LT(std::abs(value[1] - exact), std::abs(value[0] - exact));
    EXPECT_NEAR(second, exact, 1.5 * std::abs(second - first) + finite_size * exact);
}

TEST(Crack, PennyReleasesTheEnergyOfTheFormula) {
    // 8 (1 - nu^2) / 3 in all, a quarter here. In a body of half size W the crack opens more by some (a / W)^3.
    expect_extrapolated(Crack::penny, {8, 16, 24}, 8 * 0.91 / 3 / 4, 0.005);
}

TEST(Crack, GriffithReleasesTheEnergyOfTheFormula) {
    // pi (1 - nu^2) per thickness in all, half of it here. In a strip of half width W, K^2 is larger by
    // sec(pi a / 2 W) (Feddersen 1966); integrated over the crack's growth that is half of its excess at the end.
    const double strip = 1 + (1 / std::cos(std::numbers::pi / 2 / far) - 1) / 2;
    expect_extrapolated(Crack::griffith, {12, 24, 48}, std::numbers::pi * 0.91 / 2 * thickness * strip, 0.005);
}

}  // namespace
}  // namespace lancet::test
