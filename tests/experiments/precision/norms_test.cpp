// Norms of functions whose norms are known.

#include "lancet/experiments/precision/norms.hpp"

#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::precision {
namespace {

using Function = std::function<Point(const Point&)>;

mesh::Box box(int refinement, mesh::Split split = mesh::Split::five) {
    return {.cells = {2 * refinement, 3 * refinement, refinement}, .size = {2, 3, 0.5}, .split = split};
}

BoxField interpolate(const mesh::Box& of, const Function& function) {
    std::vector<Point> values;
    const mesh::TetMesh mesh = mesh::box(of);
    for (const Point& p : mesh.nodes()) values.push_back(function(p));
    return {of, values};
}

Point linear(const Point& p) {
    return {1 + 2 * p[0] - p[1], 0.5 * p[2], 3 * p[0] + p[1] - 4 * p[2]};
}

TEST(BoxField, ReproducesLinearFunctionsAndTheirGradients) {
    for (const mesh::Split split : {mesh::Split::five, mesh::Split::six}) {
        const BoxField field = interpolate(box(2, split), linear);
        for (const Point& p : {Point{0, 0, 0}, Point{2, 3, 0.5}, Point{0.3, 2.9, 0.11}, Point{1.99, 0.4, 0.49}}) {
            const BoxField::Value at = field.at(p);
            const Point exact = linear(p);
            for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(at.value[i], exact[i], 1e-13);
            EXPECT_NEAR(at.gradient[0][0], 2, 1e-12);
            EXPECT_NEAR(at.gradient[0][1], -1, 1e-12);
            EXPECT_NEAR(at.gradient[1][2], 0.5, 1e-12);
            EXPECT_NEAR(at.gradient[2][2], -4, 1e-12);
            EXPECT_NEAR(at.gradient[1][0], 0, 1e-12);
        }
    }
}

/// At nodes, and at the centre of every element, where the field is the mean of its corners.
TEST(BoxField, AgreesWithTheMeshItIsOn) {
    for (const bool swap : {false, true}) {
        mesh::Box of = box(3);
        of.swap_parity = swap;
        of.origin = {-1, 2, 5};
        const auto wild = [](const Point& p) {
            return Point{std::sin(9 * p[0]), std::cos(7 * p[1] * p[2]), p[0] * p[2]};
        };
        const BoxField field = interpolate(of, wild);
        const mesh::TetMesh mesh = mesh::box(of);
        for (const mesh::Tetrahedron& t : mesh.tetrahedra()) {
            Point centre{}, mean{};
            for (const std::int32_t node : t) {
                for (std::size_t i = 0; i < 3; ++i) {
                    centre[i] += mesh.nodes()[static_cast<std::size_t>(node)][i] / 4;
                    mean[i] += field.values()[static_cast<std::size_t>(node)][i] / 4;
                }
            }
            for (std::size_t i = 0; i < 3; ++i) ASSERT_NEAR(field.at(centre).value[i], mean[i], 1e-12);
        }
    }
}

TEST(BoxField, RefusesAnotherNumberOfValues) {
    EXPECT_THROW(BoxField(box(1), std::vector<Point>(5)), Error);
}

/// u = (x, 0, 0): int x^2 over 2 x 3 x 0.5 is 8 / 3 * 1.5 = 4; strain 1 along x, so sigma : epsilon = 2 mu + lambda.
TEST(Norms, AreExactForLinearFunctions) {
    const EnergyForm form{.young_modulus = 7, .poisson_ratio = 0.25};
    const double lame = 7 * 0.25 / (1.25 * 0.5), shear = 7 / 2.5;
    const BoxField u = interpolate(box(2), [](const Point& p) { return Point{p[0], 0, 0}; });
    const BoxField zero = interpolate(box(2), [](const Point&) { return Point{0, 0, 0}; });
    for (const Norms& found : {norms(u, form), error_norms(zero, u, form), error_norms(u, zero, form)}) {
        EXPECT_NEAR(found.l2, 2, 1e-13);
        EXPECT_NEAR(found.energy, std::sqrt((2 * shear + lame) * 3), 1e-12);
    }
    EXPECT_NEAR(error_norms(u, u, form).l2, 0, 1e-13);
    EXPECT_NEAR(error_norms(u, u, form).energy, 0, 1e-12);
}

/// Kuhn's subdivision of halved cells refines that of the cells: the quadrature on the finer mesh is exact there.
TEST(Norms, CompareAcrossNestedMeshes) {
    const EnergyForm form{.young_modulus = 3, .poisson_ratio = 0.1};
    const auto wild = [](const Point& p) { return Point{std::sin(3 * p[0]), p[1] * p[2], std::exp(p[0] - p[1])}; };
    const BoxField coarse = interpolate(box(2, mesh::Split::six), wild);
    const BoxField fine = interpolate(box(4, mesh::Split::six), [&](const Point& p) { return coarse.at(p).value; });
    const Norms none = error_norms(coarse, fine, form);
    EXPECT_NEAR(none.l2, 0, 1e-12);
    EXPECT_NEAR(none.energy, 0, 1e-11);
    const BoxField shifted = interpolate(box(4, mesh::Split::six), [&](const Point& p) {
        const Point at = coarse.at(p).value;
        return Point{at[0], at[1] + 0.5, at[2]};
    });
    EXPECT_NEAR(error_norms(coarse, shifted, form).l2, 0.5 * std::sqrt(3.0), 1e-12);
    EXPECT_NEAR(error_norms(coarse, shifted, form).energy, 0, 1e-11);
}

/// Interpolation of a smooth function: order 2 in L2, order 1 in energy, measured on a mesh four times finer.
TEST(Norms, ShowTheOrdersOfInterpolation) {
    const EnergyForm form{.young_modulus = 1, .poisson_ratio = 0.3};
    const auto smooth = [](const Point& p) { return Point{std::sin(p[0]) * p[1], std::cos(p[1] + p[2]), p[0] * p[0]}; };
    const BoxField exact = interpolate(box(16), smooth);
    const Norms coarse = error_norms(interpolate(box(2), smooth), exact, form);
    const Norms fine = error_norms(interpolate(box(4), smooth), exact, form);
    EXPECT_NEAR(std::log2(coarse.l2 / fine.l2), 2, 0.15);
    EXPECT_NEAR(std::log2(coarse.energy / fine.energy), 1, 0.15);
}

/// A body that has only been turned has no elastic energy, and a stretch is seen in its own frame.
TEST(Norms, DoNotSeeRotations) {
    const EnergyForm form{.young_modulus = 2, .poisson_ratio = 0, .rotated = true};
    const double c = std::cos(1.0), s = std::sin(1.0);
    const auto turned = [&](double stretch) {
        return interpolate(box(1), [=](const Point& p) {
            const double x = (1 + stretch) * p[0];
            return Point{c * x - s * p[1] - p[0], s * x + c * p[1] - p[1], 0};
        });
    };
    EXPECT_NEAR(norms(turned(0), form).energy, 0, 1e-12);
    // 2 mu = 2 with nu = 0; volume 3.
    EXPECT_NEAR(norms(turned(0.1), form).energy, std::sqrt(2 * 0.01 * 3), 1e-12);
    EXPECT_NEAR(error_norms(turned(0.1), turned(0), form).energy, std::sqrt(2 * 0.01 * 3), 1e-12);
}

}  // namespace
}  // namespace lancet::experiments::precision
