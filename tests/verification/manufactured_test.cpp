// A smooth displacement whose loads are known: linear tetrahedra converge in second order in L2, in first in energy.
#include <array>
#include <cmath>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/simulate/equilibrium.hpp"

namespace lancet::test {
namespace {

using mesh::Point;
using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

constexpr double young = 1e5, poisson = 0.3;
constexpr double lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), mu = young / (2 * (1 + poisson));

/// u_i = a_i sin(k_i . x + i), small beside one: the model is linear.
const std::array<Vector, 3> wave{Vector(1.9, 0.7, -0.4), Vector(-0.6, 2.1, 0.8), Vector(0.5, -0.9, 1.7)};
const Vector amplitude(1e-2, -0.8e-2, 1.2e-2);

double phase(int i, const Vector& x) {
    return wave[static_cast<std::size_t>(i)].dot(x) + i;
}
Vector displacement(const Vector& x) {
    return {amplitude[0] * std::sin(phase(0, x)), amplitude[1] * std::sin(phase(1, x)),
            amplitude[2] * std::sin(phase(2, x))};
}
Matrix gradient(const Vector& x) {
    Matrix g;
    for (int i = 0; i < 3; ++i) {
        g.row(i) = amplitude[i] * std::cos(phase(i, x)) * wave[static_cast<std::size_t>(i)].transpose();
    }
    return g;
}
/// The force per volume that holds it: -div sigma = -(mu lap u + (lambda + mu) grad div u).
Vector body_force(const Vector& x) {
    Vector force = Vector::Zero();
    for (int i = 0; i < 3; ++i) {
        const Vector& k = wave[static_cast<std::size_t>(i)];
        const double u = amplitude[i] * std::sin(phase(i, x));
        force[i] += mu * k.squaredNorm() * u;
        force += (lambda + mu) * k[i] * u * k;
    }
    return force;
}

/// Points and weights of Keast's rule of degree 3 on a tetrahedron (1986), in barycentric coordinates.
struct Quadrature {
    std::array<double, 4> weights;
    double share;
};
const std::array<Quadrature, 5> rule{{{{0.25, 0.25, 0.25, 0.25}, -0.8},
                                      {{0.5, 1.0 / 6, 1.0 / 6, 1.0 / 6}, 0.45},
                                      {{1.0 / 6, 0.5, 1.0 / 6, 1.0 / 6}, 0.45},
                                      {{1.0 / 6, 1.0 / 6, 0.5, 1.0 / 6}, 0.45},
                                      {{1.0 / 6, 1.0 / 6, 1.0 / 6, 0.5}, 0.45}}};

struct Errors {
    double l2, energy;
};

Errors errors(int cells, mesh::Split split) {
    runtime::Scene scene;
    scene.mesh = mesh::box({.cells = {cells, cells, cells}, .size = {1, 1, 1}, .split = split});
    scene.materials = {{0, {.young_modulus = young, .poisson_ratio = poisson, .density = 1}}};
    scene.gravity = {0, 0, 0};
    const std::span<const Point> nodes = scene.mesh.nodes();
    const auto at = [&](std::int32_t node) { return Vector(nodes[static_cast<std::size_t>(node)].data()); };
    for (std::size_t node = 0; node < nodes.size(); ++node) {
        const Vector x(nodes[node].data());
        if (x.minCoeff() > 1e-9 && x.maxCoeff() < 1 - 1e-9) continue;
        const Vector u = displacement(x);
        for (int axis = 0; axis < 3; ++axis) {
            const double value = u[axis];
            scene.prescribed.push_back({static_cast<std::int32_t>(node), axis, [value](double) { return value; }});
        }
    }
    const auto point = [&](const mesh::Tetrahedron& tetrahedron, const Quadrature& q) {
        Vector x = Vector::Zero();
        for (std::size_t corner = 0; corner < 4; ++corner) x += q.weights[corner] * at(tetrahedron[corner]);
        return x;
    };
    for (std::size_t e = 0; e < scene.mesh.tetrahedra().size(); ++e) {
        const mesh::Tetrahedron& tetrahedron = scene.mesh.tetrahedra()[e];
        const double volume = scene.mesh.volume(static_cast<std::int32_t>(e));
        for (const Quadrature& q : rule) {
            const Vector force = q.share * volume * body_force(point(tetrahedron, q));
            for (std::size_t corner = 0; corner < 4; ++corner) {
                const Vector share = q.weights[corner] * force;
                scene.nodal_loads.push_back({tetrahedron[corner], {share[0], share[1], share[2]}});
            }
        }
    }
    runtime::EquilibriumSettings settings;
    settings.model = runtime::ElementModel::linear;
    const auto scheduler = runtime::make_scheduler(runtime::default_scheduler, 2);
    std::vector<Point> positions(nodes.begin(), nodes.end());
    const auto report = find_equilibrium(scene, settings, *scheduler, positions);
    EXPECT_EQ(report.end, runtime::EquilibriumEnd::converged) << report.explanation;

    double square = 0, energy = 0;
    for (std::size_t e = 0; e < scene.mesh.tetrahedra().size(); ++e) {
        const mesh::Tetrahedron& tetrahedron = scene.mesh.tetrahedra()[e];
        const double volume = scene.mesh.volume(static_cast<std::int32_t>(e));
        Matrix edges, moved;
        std::array<Vector, 4> u;
        for (std::size_t corner = 0; corner < 4; ++corner) {
            const auto node = static_cast<std::size_t>(tetrahedron[corner]);
            u[corner] = Vector(positions[node].data()) - at(tetrahedron[corner]);
        }
        for (int j = 0; j < 3; ++j) {
            edges.col(j) = at(tetrahedron[static_cast<std::size_t>(j) + 1]) - at(tetrahedron[0]);
            moved.col(j) = u[static_cast<std::size_t>(j) + 1] - u[0];
        }
        const Matrix found = moved * edges.inverse();
        for (const Quadrature& q : rule) {
            const Vector x = point(tetrahedron, q);
            Vector interpolated = Vector::Zero();
            for (std::size_t corner = 0; corner < 4; ++corner) interpolated += q.weights[corner] * u[corner];
            square += q.share * volume * (interpolated - displacement(x)).squaredNorm();
            const Matrix g = found - gradient(x), strain = 0.5 * (g + g.transpose());
            energy += q.share * volume * (mu * strain.squaredNorm() + 0.5 * lambda * strain.trace() * strain.trace());
        }
    }
    return {std::sqrt(square), std::sqrt(energy)};
}

TEST(ManufacturedSolution, ConvergesInTheOrdersOfLinearElements) {
    for (const mesh::Split split : {mesh::Split::five, mesh::Split::six}) {
        SCOPED_TRACE(split == mesh::Split::five ? "five elements to a cell" : "six elements to a cell");
        const std::array<Errors, 3> on{errors(6, split), errors(12, split), errors(24, split)};
        for (std::size_t k = 1; k < 3; ++k) {
            const double l2 = std::log2(on[k - 1].l2 / on[k].l2), energy = std::log2(on[k - 1].energy / on[k].energy);
            std::printf("    orders: L2 %.3f, energy %.3f (errors %.3g, %.3g)\n", l2, energy, on[k].l2, on[k].energy);
            // Theory's orders are limits; the terms behind them are a power of h smaller.
            EXPECT_NEAR(l2, 2, k == 1 ? 0.1 : 0.05);
            EXPECT_NEAR(energy, 1, k == 1 ? 0.1 : 0.05);
        }
    }
}

}  // namespace
}  // namespace lancet::test
