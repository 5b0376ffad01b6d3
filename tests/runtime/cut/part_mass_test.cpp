#include "lancet/runtime/cut/part_mass.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {
namespace {

constexpr std::array all_kinds{MassKind::lumped, MassKind::weighted_diagonal, MassKind::consistent, MassKind::fraction};

/// Sums of a few numbers of one sign.
constexpr double rounding = 32 * std::numeric_limits<double>::epsilon();

double sum(const std::array<double, 4>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

/// The corner of a tetrahedron next to node 0, its edges shortened to `scale`.
mesh::PartMoments corner_part(double scale) {
    mesh::PartMoments part = mesh::empty_moments();
    const double rest = 1 - scale;
    mesh::add_tetrahedron(part, {{{1, 0, 0, 0}, {rest, scale, 0, 0}, {rest, 0, scale, 0}, {rest, 0, 0, scale}}});
    return part;
}

mesh::PartMoments random_part(std::mt19937& random) {
    std::exponential_distribution<double> positive(1.0);
    std::array<mesh::Barycentric, 4> corners{};
    for (mesh::Barycentric& corner : corners) {
        for (double& value : corner) value = positive(random);
        const double total = sum(corner);
        for (double& value : corner) value /= total;
    }
    mesh::PartMoments part = mesh::empty_moments();
    mesh::add_tetrahedron(part, corners);
    return part;
}

TEST(PartMass, OfAWholeElementEveryLumpingIsAQuarter) {
    for (const MassKind kind : all_kinds) {
        SCOPED_TRACE(to_string(kind));
        for (const double mass : corner_masses(kind, mesh::PartMoments{})) EXPECT_DOUBLE_EQ(mass, 0.25);
    }
    const auto consistent = corner_mass_matrix(MassKind::consistent, mesh::PartMoments{});
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) EXPECT_EQ(consistent[i][j], i == j ? 0.1 : 0.05);
    }
}

TEST(PartMass, TheCornersOfAPartCarryItsMass) {
    std::mt19937 random(3);
    for (int sample = 0; sample < 50; ++sample) {
        const mesh::PartMoments part = random_part(random);
        for (const MassKind kind : all_kinds) {
            SCOPED_TRACE(to_string(kind));
            const auto masses = corner_masses(kind, part);
            EXPECT_NEAR(sum(masses), part.fraction, rounding * part.fraction);
            const auto matrix = corner_mass_matrix(kind, part);
            for (std::size_t i = 0; i < 4; ++i) {
                EXPECT_GE(masses[i], 0);
                EXPECT_NEAR(sum(matrix[i]), masses[i], rounding * part.fraction);
            }
        }
    }
}

TEST(PartMass, RowSumsKeepTheCentreOfMassAndTheConsistentMassTheInertia) {
    // Of the corner at node 0, known in closed form: coordinate lambda_1 has the mean s/4 and the mean square s^2/10.
    for (const double s : {0.7, 0.1, std::cbrt(1e-14)}) {
        const mesh::PartMoments part = corner_part(s);
        const double v = s * s * s;
        const auto rows = corner_masses(MassKind::lumped, part);
        EXPECT_NEAR(rows[1] / v, s / 4, rounding * s);
        EXPECT_NEAR(rows[0] / v, 1 - 0.75 * s, rounding);
        const auto consistent = corner_mass_matrix(MassKind::consistent, part);
        EXPECT_NEAR(consistent[1][1] / v, s * s / 10, rounding * s * s);
        EXPECT_NEAR(consistent[1][2] / v, s * s / 20, rounding * s * s);
    }
}

TEST(PartMass, FractionAndWeightedDiagonalOfAThinCorner) {
    const double s = std::cbrt(1e-14);
    const double v = s * s * s;
    const mesh::PartMoments part = corner_part(s);
    for (const double mass : corner_masses(MassKind::fraction, part)) EXPECT_NEAR(mass, v / 4, rounding * v);
    const auto diagonal = corner_masses(MassKind::weighted_diagonal, part);
    const double own = 1 - 1.5 * s + 0.6 * s * s;
    const double other = s * s / 10;
    EXPECT_NEAR(diagonal[0], v * own / (own + 3 * other), rounding * v);
    EXPECT_NEAR(diagonal[2], v * other / (own + 3 * other), rounding * v * other);
}

TEST(PartMass, NothingWeighsNothing) {
    for (const MassKind kind : all_kinds) {
        for (const double mass : corner_masses(kind, mesh::empty_moments())) EXPECT_EQ(mass, 0);
    }
}

TEST(PartMass, KindsHaveNames) {
    for (const MassKind kind : all_kinds) EXPECT_EQ(mass_kind_from_string(to_string(kind)), kind);
    EXPECT_THROW(mass_kind_from_string("heavy"), Error);
}

}  // namespace
}  // namespace lancet::runtime
