// The step matrix of a cut body against one assembled densely from its parts, for every operator, mass and scalar.
#include <cmath>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "lancet/kernels/layout/element_batches.hpp"
#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"
#include "lancet/runtime/cut/part_mass.hpp"
#include "lancet/runtime/simulate/body.hpp"

namespace lancet::test {
namespace {

using mesh::CutSurface;
using mesh::Point;

runtime::Scene cut_bar() {
    runtime::Scene scene;
    scene.mesh = mesh::box({.cells = {4, 2, 2}, .size = {0.4, 0.2, 0.2}});
    scene.materials = {{0, {.young_modulus = 2e4, .poisson_ratio = 0.3, .density = 700}}};
    const auto left = scene.mesh.node_set("x_min");
    scene.fixed_nodes.assign(left.begin(), left.end());
    mesh::CutMesh cut(scene.mesh);
    cut.cut(CutSurface::plane({0.23, 0, 0}, {1, 0.2, 0.1}));
    cut.cut(CutSurface::half_plane({0.3, 0.13, 0}, {0, 1, 0.1}, {1, 0, 0}));
    cut.cut(CutSurface::plane({0.1001, 0, 0}, {1, 0, 0}));
    return divided(scene, cut);
}

/// M + h^2 K at rest, over all copies.
Eigen::MatrixXd step_matrix(const runtime::Scene& scene, runtime::MassKind kind, double h) {
    const auto size = static_cast<Eigen::Index>(3 * scene.mesh.nodes().size());
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(size, size);
    const auto material = elastic_parameters(scene.materials.at(0));
    for (std::size_t e = 0; e < scene.mesh.tetrahedra().size(); ++e) {
        const mesh::Tetrahedron& nodes = scene.mesh.tetrahedra()[e];
        const auto geometry = kernels::tetrahedron_geometry(scene.mesh.nodes(), nodes);
        const mesh::PartMoments part = scene.parts.of(e);
        const auto mass = corner_mass_matrix(kind, part);
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                const Eigen::Vector3d bi = Eigen::Map<const Eigen::Vector3d>(geometry.gradients[i].data()),
                                      bj = Eigen::Map<const Eigen::Vector3d>(geometry.gradients[j].data());
                const Eigen::Matrix3d k = part.fraction * geometry.volume *
                                          (material.lambda * bi * bj.transpose() + material.mu * bj * bi.transpose() +
                                           material.mu * bi.dot(bj) * Eigen::Matrix3d::Identity());
                a.block<3, 3>(3 * nodes[i], 3 * nodes[j]) +=
                    material.density * geometry.volume * mass[i][j] * Eigen::Matrix3d::Identity() + h * h * k;
            }
        }
    }
    return a;
}

TEST(PartOperator, EqualsTheDenseMatrixOfTheParts) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    const runtime::Scene scene = cut_bar();
    const std::size_t nodes = scene.mesh.nodes().size();
    std::vector<bool> is_fixed(nodes, false);
    for (const std::int32_t node : scene.fixed_nodes) is_fixed[static_cast<std::size_t>(node)] = true;
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    std::vector<Point> z(nodes);
    Eigen::VectorXd dense_z = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * nodes));
    for (std::size_t node = 0; node < nodes; ++node) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            z[node][axis] = is_fixed[node] ? 0 : normal(random);
            dense_z[static_cast<Eigen::Index>(3 * node + axis)] = z[node][axis];
        }
    }
    for (const auto mass : {runtime::MassKind::lumped, runtime::MassKind::weighted_diagonal,
                            runtime::MassKind::consistent, runtime::MassKind::fraction}) {
        const Eigen::MatrixXd a = step_matrix(scene, mass, 0.02);
        const Eigen::VectorXd expected = a * dense_z;
        const Eigen::VectorXd size = a.cwiseAbs() * dense_z.cwiseAbs();
        for (const auto matrix : {runtime::OperatorKind::matrix_free, runtime::OperatorKind::edge_blocks,
                                  runtime::OperatorKind::block_rows}) {
            for (const auto scalar : {runtime::ScalarMode::single_precision, runtime::ScalarMode::double_precision}) {
                runtime::Settings settings;
                settings.mass = mass;
                settings.matrix = matrix;
                settings.scalar = scalar;
                settings.time_step = 0.02;
                const auto body = make_body(scene, settings, *scheduler);
                std::vector<Point> y(nodes);
                body->apply_matrix(*scheduler, z, y);
                const double epsilon = scalar == runtime::ScalarMode::double_precision ? 0x1p-52 : 0x1p-23;
                for (std::size_t node = 0; node < nodes; ++node) {
                    if (is_fixed[node]) continue;
                    // The entries of a row come from the thickest part of its elements: sums of tens of roundings.
                    const auto row = static_cast<Eigen::Index>(3 * node);
                    const double rounding = 64 * epsilon * size.segment<3>(row).maxCoeff();
                    for (std::size_t axis = 0; axis < 3; ++axis) {
                        EXPECT_NEAR(y[node][axis], expected[row + static_cast<Eigen::Index>(axis)], rounding)
                            << to_string(mass) << ' ' << to_string(matrix) << ' ' << to_string(scalar) << " node "
                            << node;
                    }
                }
            }
        }
    }
}

}  // namespace
}  // namespace lancet::test
