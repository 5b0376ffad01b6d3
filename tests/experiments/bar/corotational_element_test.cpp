#include "lancet/experiments/bar/corotational_element.hpp"

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "lancet/experiments/bar/energy.hpp"

namespace lancet::experiments::bar {
namespace {

using Element = CorotationalElement<double>;
using Vector = Vector3<double>;
using Matrix = Matrix3<double>;

Problem one_cell() {
    ProblemOptions options;
    options.cells = {1, 1, 1};
    options.size = {1.0, 0.7, 1.3};
    return make_problem(options);
}

Matrix rotation_about(const std::array<double, 3>& axis, double angle) {
    const double length = std::sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    const double x = axis[0] / length, y = axis[1] / length, z = axis[2] / length;
    const double c = std::cos(angle), s = std::sin(angle), t = 1 - c;
    return {{t * x * x + c, t * x * y - s * z, t * x * z + s * y, t * x * y + s * z, t * y * y + c, t * y * z - s * x,
             t * x * z - s * y, t * y * z + s * x, t * z * z + c}};
}

std::vector<Vector> mapped(const Problem& problem, const Matrix& matrix, const Vector& shift) {
    std::vector<Vector> result;
    for (const mesh::Point& p : problem.mesh.nodes()) result.push_back(matrix * Vector{p[0], p[1], p[2]} + shift);
    return result;
}

double norm(const Vector& v) {
    return std::sqrt(dot(v, v));
}

TEST(CorotationalElement, RigidMotionGivesNoForce) {
    const Problem problem = one_cell();
    for (const double angle : {0.0, 0.3, 1.5, 3.0, -3.1}) {
        const auto x = mapped(problem, rotation_about({1, -2, 0.5}, angle), {10, -20, 30});
        for (const mesh::Tetrahedron& nodes : problem.mesh.tetrahedra()) {
            Element element = make_element<double>(problem, nodes);
            element.rotate(x);
            for (const Vector& force : element.forces(x)) EXPECT_LT(norm(force), 1e-9 * problem.young_modulus);
        }
    }
}

TEST(CorotationalElement, StretchAlongAnAxisGivesTheStressOfHooke) {
    const Problem problem = one_cell();
    const double strain = 0.1;
    const auto x = mapped(problem, {{1 + strain, 0, 0, 0, 1, 0, 0, 0, 1}}, {0, 0, 0});
    // Constrained stretch: sigma_x = (lambda + 2 mu) strain, on the face x = 1 of area 0.7 * 1.3.
    const double nu = problem.poisson_ratio;
    const double modulus = problem.young_modulus * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
    double force_on_face = 0;
    Vector total{};
    for (const mesh::Tetrahedron& nodes : problem.mesh.tetrahedra()) {
        Element element = make_element<double>(problem, nodes);
        element.rotate(x);
        const auto forces = element.forces(x);
        for (std::size_t i = 0; i < 4; ++i) {
            total = total + forces[i];
            if (problem.mesh.nodes()[static_cast<std::size_t>(nodes[i])][0] > 0.5) force_on_face += forces[i].x;
        }
    }
    EXPECT_NEAR(force_on_face, -modulus * strain * 0.7 * 1.3, 1e-9 * modulus);
    EXPECT_LT(norm(total), 1e-9 * modulus);
}

TEST(CorotationalElement, ForceIsTheNegativeGradientOfTheEnergy) {
    const Problem problem = one_cell();
    std::mt19937 random(7);
    std::uniform_real_distribution<double> jitter(-0.15, 0.15);
    auto x = mapped(problem, rotation_about({1, 1, 0}, 1.0), {0, 0, 0});
    for (Vector& p : x) p = p + Vector{jitter(random), jitter(random), jitter(random)};

    std::vector<Vector> forces(x.size(), Vector{});
    for (const mesh::Tetrahedron& nodes : problem.mesh.tetrahedra()) {
        Element element = make_element<double>(problem, nodes);
        element.rotate(x);
        const auto f = element.forces(x);
        for (std::size_t i = 0; i < 4; ++i) forces[nodes[i]] = forces[nodes[i]] + f[i];
    }
    std::vector<double> flat;
    for (const Vector& p : x) flat.insert(flat.end(), {p.x, p.y, p.z});
    const std::vector<double> at_rest(flat.size(), 0.0);
    constexpr double step = 1e-5;
    for (std::size_t i = 0; i < flat.size(); ++i) {
        const double before = flat[i];
        flat[i] = before + step;
        const double above = energy(problem, flat, at_rest).elastic;
        flat[i] = before - step;
        const double below = energy(problem, flat, at_rest).elastic;
        flat[i] = before;
        const Vector& force = forces[i / 3];
        const double component = i % 3 == 0 ? force.x : (i % 3 == 1 ? force.y : force.z);
        EXPECT_NEAR(component, -(above - below) / (2 * step), 1e-5 * problem.young_modulus) << "component " << i;
    }
}

TEST(CorotationalElement, BlocksAreSymmetricAndMultiplyLikeTheForce) {
    const Problem problem = one_cell();
    const auto x = mapped(problem, rotation_about({0, 1, 3}, 2.0), {0, 0, 0});
    Element element = make_element<double>(problem, problem.mesh.tetrahedra()[0]);
    element.rotate(x);
    const ElementBlocks<double> blocks = element.rotated_stiffness(1.0);
    auto moved = x;  // small, so that the rotation may stay
    std::mt19937 random(11);
    std::uniform_real_distribution<double> jitter(-1, 1);
    std::array<Vector, 4> change;
    for (std::size_t i = 0; i < 4; ++i) {
        change[i] = {jitter(random), jitter(random), jitter(random)};
        moved[element.nodes[i]] = moved[element.nodes[i]] + change[i];
    }
    const auto forces = element.forces(moved);
    for (std::size_t i = 0; i < 4; ++i) {
        Vector product{};
        for (std::size_t j = 0; j < 4; ++j) {
            product = product + blocks[4 * i + j] * change[j];
            for (std::size_t entry = 0; entry < 9; ++entry) {
                EXPECT_NEAR(blocks[4 * i + j].m[entry], blocks[4 * j + i].transposed().m[entry],
                            1e-12 * problem.young_modulus);
            }
        }
        EXPECT_LT(norm(product + forces[i]), 1e-10 * problem.young_modulus);
    }
}

template <class Scalar>
class UpdateRotation : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(UpdateRotation, Scalars);

TYPED_TEST(UpdateRotation, FindsTheRotationOfAStretchedFrame) {
    const Matrix rotation = rotation_about({3, -1, 2}, 2.5);
    for (const double stretch : {1.0, 1.3, 0.2, 8.0}) {
        const Matrix gradient = rotation * Matrix{{stretch, 0.05, 0, 0.05, 1, 0, 0, 0, 1 / stretch}};
        Matrix3<TypeParam> f, r{};
        for (std::size_t i = 0; i < 9; ++i) f.m[i] = static_cast<TypeParam>(gradient.m[i]);
        ASSERT_TRUE(update_rotation(f, r));
        for (std::size_t i = 0; i < 9; ++i) {
            EXPECT_NEAR(double(r.m[i]), rotation.m[i], 40 * std::numeric_limits<TypeParam>::epsilon());
        }
    }
}

TYPED_TEST(UpdateRotation, LeavesTheRotationOfFlatAndInvertedElements) {
    const Matrix3<TypeParam> before{{0, -1, 0, 1, 0, 0, 0, 0, 1}};
    for (const Matrix3<TypeParam>& gradient :
         {Matrix3<TypeParam>{{1, 0, 0, 0, 1, 0, 0, 0, 0}}, Matrix3<TypeParam>{{1, 0, 0, 0, 1, 0, 0, 0, -1}},
          Matrix3<TypeParam>{}}) {
        Matrix3<TypeParam> rotation = before;
        EXPECT_FALSE(update_rotation(gradient, rotation));
        EXPECT_EQ(rotation.m, before.m);
    }
}

}  // namespace
}  // namespace lancet::experiments::bar
