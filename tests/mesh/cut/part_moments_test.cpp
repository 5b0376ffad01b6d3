#include "lancet/mesh/cut/part_moments.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace lancet::mesh {
namespace {

using Tetrahedron = std::array<Barycentric, 4>;

constexpr Tetrahedron whole{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};

/// A moment is a sum of a few dozen products of numbers of one sign, each rounded once or twice.
constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();

PartMoments moments_of(const std::vector<Tetrahedron>& tetrahedra) {
    PartMoments moments = empty_moments();
    for (const Tetrahedron& tetrahedron : tetrahedra) add_tetrahedron(moments, tetrahedron);
    return moments;
}

void expect_relative(double value, double expected, double tolerance) {
    EXPECT_NEAR(value, expected, tolerance * std::abs(expected));
}

void expect_equal(const PartMoments& moments, const PartMoments& expected, double tolerance) {
    expect_relative(moments.fraction, expected.fraction, tolerance);
    for (std::size_t i = 0; i < 4; ++i) {
        expect_relative(moments.first[i], expected.first[i], tolerance);
        for (std::size_t j = 0; j < 4; ++j) {
            expect_relative(moments.second[i][j], expected.second[i][j], tolerance);
        }
    }
}

void expect_invariants(const PartMoments& moments) {
    double fraction = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        double first = 0;
        fraction += moments.first[i];
        for (std::size_t j = 0; j < 4; ++j) {
            first += moments.second[i][j];
            EXPECT_EQ(moments.second[i][j], moments.second[j][i]);
        }
        expect_relative(first, moments.first[i], rounding);
    }
    expect_relative(fraction, moments.fraction, rounding);
}

/// The point between corners a and b, `t` of the way from a.
Barycentric on_edge(std::size_t a, std::size_t b, double t) {
    Barycentric point{};
    point[a] = 1 - t;
    point[b] += t;
    return point;
}

/// A triangular prism between corners a_k and b_k, as three tetrahedra.
std::vector<Tetrahedron> prism(const std::array<Barycentric, 3>& a, const std::array<Barycentric, 3>& b) {
    return {{a[0], a[1], a[2], b[2]}, {a[0], a[1], b[1], b[2]}, {a[0], b[0], b[1], b[2]}};
}

TEST(PartMoments, TheWholeTetrahedronIsTheDefault) {
    expect_equal(moments_of({whole}), PartMoments{}, rounding);
    expect_invariants(PartMoments{});
}

TEST(PartMoments, NothingHasNone) {
    const PartMoments nothing = empty_moments();
    EXPECT_EQ(nothing.fraction, 0);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(nothing.first[i], 0);
        for (std::size_t j = 0; j < 4; ++j) EXPECT_EQ(nothing.second[i][j], 0);
    }
    // A tetrahedron without volume adds nothing either.
    PartMoments flat = empty_moments();
    add_tetrahedron(flat, {whole[0], whole[1], whole[2], on_edge(0, 1, 0.375)});
    EXPECT_EQ(flat.fraction, 0);
    EXPECT_EQ(flat.second[0][1], 0);
}

TEST(PartMoments, ACornerHasItsClosedFormula) {
    // The corner at node 0 with edges shortened to s: lambda_0 = 1 - s + s mu_0, lambda_i = s mu_i, with mu the
    // barycentric coordinates of the corner: fraction s^3, first_0 = s^3 (1 - 3/4 s), first_i = s^4 / 4, second_00 =
    // s^3 (1 - 3/2 s + 3/5 s^2), second_0i = s^4 (1 - s)/4 + s^5/20, second_ij = s^5 (1 + delta_ij)/20.
    for (const double s : {0.5, 0.1, 1e-3, std::cbrt(1e-14)}) {
        SCOPED_TRACE(s);
        PartMoments expected;
        const double s3 = s * s * s;
        expected.fraction = s3;
        expected.first = {s3 * (1 - 0.75 * s), s3 * s / 4, s3 * s / 4, s3 * s / 4};
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                const double both = s3 * s * s * (i == j ? 2 : 1) / 20;
                const double one = s3 * s * (1 - s) / 4 + s3 * s * s / 20;
                const double none = s3 * (1 - 1.5 * s + 0.6 * s * s);
                expected.second[i][j] = i == 0 && j == 0 ? none : i == 0 || j == 0 ? one : both;
            }
        }
        const PartMoments corner = moments_of({{whole[0], on_edge(0, 1, s), on_edge(0, 2, s), on_edge(0, 3, s)}});
        expect_equal(corner, expected, rounding);
        expect_invariants(corner);
    }
}

TEST(PartMoments, ASlabOnAFaceHasItsClosedFormula) {
    // lambda_0 < t: int lambda_0^n over the slab is int_0^t 3 (1 - z)^2 z^n dz, with all powers of t written out.
    for (const double t : {0.5, 0.02, 1e-7, 1e-14 / 3}) {
        SCOPED_TRACE(t);
        const PartMoments slab =
            moments_of(prism({whole[1], whole[2], whole[3]}, {on_edge(1, 0, t), on_edge(2, 0, t), on_edge(3, 0, t)}));
        expect_relative(slab.fraction, t * (3 - 3 * t + t * t), rounding);
        expect_relative(slab.first[0], t * t * (1.5 - 2 * t + 0.75 * t * t), rounding);
        expect_relative(slab.second[0][0], t * t * t * (1 - 1.5 * t + 0.6 * t * t), rounding);
        EXPECT_NEAR(slab.first[1], slab.first[2], rounding * slab.first[1]);
        EXPECT_NEAR(slab.first[1], slab.first[3], rounding * slab.first[1]);
        expect_invariants(slab);
    }
}

TEST(PartMoments, AWedgeOnAnEdgeHasItsClosedFormula) {
    // s = lambda_2 + lambda_3 < t: the density of s is 6 s (1 - s), and on average lambda_2 = s/2, lambda_2 lambda_3 =
    // s^2/6, lambda_2^2 = s^2/3, lambda_0 lambda_2 = s (1 - s)/4.
    for (const double t : {0.5, 0.03, 1e-4, 1e-7 / std::sqrt(3)}) {
        SCOPED_TRACE(t);
        const PartMoments wedge = moments_of(
            prism({whole[0], on_edge(0, 2, t), on_edge(0, 3, t)}, {whole[1], on_edge(1, 2, t), on_edge(1, 3, t)}));
        const double t2 = t * t;
        const double t4 = t2 * t2;
        expect_relative(wedge.fraction, t2 * (3 - 2 * t), rounding);
        expect_relative(wedge.first[2], t2 * t * (1 - 0.75 * t), rounding);
        expect_relative(wedge.second[2][3], t4 * (0.25 - 0.2 * t), rounding);
        expect_relative(wedge.second[2][2], t4 * (0.5 - 0.4 * t), rounding);
        expect_relative(wedge.second[0][2], t2 * t * (0.5 - 0.75 * t + 0.3 * t2), rounding);
        expect_invariants(wedge);
    }
}

TEST(PartMoments, PartsAddUpToTheWhole) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> inside(0.0, 1.0);
    for (int sample = 0; sample < 100; ++sample) {
        const double s1 = inside(random), s2 = inside(random), s3 = inside(random);
        const Barycentric p1 = on_edge(1, 0, s1), p2 = on_edge(2, 0, s2), p3 = on_edge(3, 0, s3);
        std::vector<Tetrahedron> parts = prism({whole[1], whole[2], whole[3]}, {p1, p2, p3});
        parts.push_back({whole[0], p1, p2, p3});
        // The differences of numbers of order one are rounded: an absolute error of the volume, relative to the whole.
        expect_equal(moments_of(parts), PartMoments{}, 2 * rounding);
    }
}

TEST(PartMoments, EveryOrderOfTheCornersGivesTheSameToRelativeRounding) {
    // Cuts that pass the corners of one face at distances of very different size: the volumes are products of them.
    const double s1 = 3e-2, s2 = 7e-14, s3 = 2e-3;
    const Barycentric p1 = on_edge(1, 0, s1), p2 = on_edge(2, 0, s2), p3 = on_edge(3, 0, s3);
    struct Sample {
        Tetrahedron corners;
        double fraction;
    };
    for (const Sample& sample :
         {Sample{{whole[1], whole[2], whole[3], p2}, s2}, Sample{{whole[1], whole[2], p2, p3}, s2 * (1 - s3)},
          Sample{{whole[1], p1, p2, p3}, s1 * (1 - s2) * (1 - s3)},
          Sample{{whole[0], on_edge(0, 1, s1), on_edge(0, 2, s2), on_edge(0, 3, s3)}, s1 * s2 * s3}}) {
        std::array<std::size_t, 4> order{0, 1, 2, 3};
        const PartMoments reference = moments_of({sample.corners});
        do {
            Tetrahedron corners{};
            for (std::size_t k = 0; k < 4; ++k) corners[k] = sample.corners[order[k]];
            const PartMoments moments = moments_of({corners});
            expect_relative(moments.fraction, sample.fraction, rounding);
            expect_equal(moments, reference, rounding);
            expect_invariants(moments);
        } while (std::ranges::next_permutation(order).found);
    }
}

TEST(PartMoments, AQuadratureOfDegreeTwoAgrees) {
    // Second moments against a quadrature of degree two on the tetrahedron itself: four points with weight v/4.
    std::mt19937 random(11);
    std::exponential_distribution<double> positive(1.0);
    const double a = (5 + 3 * std::sqrt(5.0)) / 20, b = (5 - std::sqrt(5.0)) / 20;
    for (int sample = 0; sample < 50; ++sample) {
        Tetrahedron corners{};
        for (Barycentric& corner : corners) {
            double sum = 0;
            for (double& value : corner) sum += value = positive(random);
            for (double& value : corner) value /= sum;
        }
        const PartMoments moments = moments_of({corners});
        PartMoments expected = empty_moments();
        expected.fraction = moments.fraction;
        for (std::size_t point = 0; point < 4; ++point) {
            Barycentric x{};
            for (std::size_t k = 0; k < 4; ++k) {
                for (std::size_t i = 0; i < 4; ++i) x[i] += (k == point ? a : b) * corners[k][i];
            }
            for (std::size_t i = 0; i < 4; ++i) {
                expected.first[i] += moments.fraction / 4 * x[i];
                for (std::size_t j = 0; j < 4; ++j) expected.second[i][j] += moments.fraction / 4 * x[i] * x[j];
            }
        }
        expect_equal(moments, expected, rounding);
        expect_invariants(moments);
    }
}

}  // namespace
}  // namespace lancet::mesh
