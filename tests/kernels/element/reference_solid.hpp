#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tests/kernels/element/reference_material.hpp"
#include <Eigen/Dense>

#include "lancet/kernels/layout/element_batches.hpp"

namespace lancet::test {

using kernels::Point;
using kernels::Tetrahedron;

/// An isotropic material by its engineering constants.
struct ReferenceMaterial {
    double young_modulus;
    double poisson_ratio;
    double density;

    double lambda() const { return young_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio)); }
    double mu() const { return young_modulus / (2 * (1 + poisson_ratio)); }
};

/// Linear tetrahedra written from first principles in double, dense and without any thought of speed: what the library
/// is compared with. Vectors of unknowns hold x, y, z of node 0, then of node 1, ...
struct ReferenceSolid {
    std::vector<Point> nodes;
    std::vector<Tetrahedron> tetrahedra;
    std::vector<std::int32_t> regions;  ///< of each element: an index into materials
    std::vector<ReferenceMaterial> materials;
    std::vector<std::int32_t> fixed;

    Eigen::Index unknowns() const { return 3 * static_cast<Eigen::Index>(nodes.size()); }
    const ReferenceMaterial& material(std::size_t element) const { return materials[regions[element]]; }
    double volume(std::size_t element) const;
    Eigen::Matrix3d deformation_gradient(std::size_t element, const Eigen::VectorXd& positions) const;
    /// V B^T C B in Voigt's notation.
    Eigen::Matrix<double, 12, 12> element_stiffness(std::size_t element) const;

    Eigen::VectorXd rest() const;
    Eigen::MatrixXd mass(bool consistent) const;
    /// sum R K R^T, with R the rotations at `positions` if corotational, else 1.
    Eigen::MatrixXd stiffness(const Eigen::VectorXd& positions, bool corotational) const;
    /// -sum R K (R^T x - X).
    Eigen::VectorXd elastic_force(const Eigen::VectorXd& positions, bool corotational) const;
    /// sum V (mu |R^T F - 1|^2 + lambda / 2 tr(R^T F - 1)^2), with the symmetric part of F - 1 if not corotational.
    double elastic_energy(const Eigen::VectorXd& positions, bool corotational) const;
    /// The energy, -dW/dx and d^2 W/dx^2 (or what stands for it) of any material, element by element from F.
    double elastic_energy(const Eigen::VectorXd& positions, kernels::MaterialModel model) const;
    Eigen::VectorXd elastic_force(const Eigen::VectorXd& positions, kernels::MaterialModel model) const;
    Eigen::MatrixXd stiffness(const Eigen::VectorXd& positions, kernels::MaterialModel model,
                              kernels::TangentKind kind) const;
    Eigen::Matrix<double, 12, 12> element_stiffness(std::size_t element, const Eigen::VectorXd& positions,
                                                    kernels::MaterialModel model, kernels::TangentKind kind) const;
    PointwiseReference law(std::size_t element, kernels::MaterialModel model) const {
        return {model, material(element).lambda(), material(element).mu()};
    }
    /// True for the unknowns of nodes that are not fixed.
    std::vector<std::uint8_t> free_unknowns() const;
};

/// Rows and columns (entries) of the unknowns that are marked.
Eigen::MatrixXd restricted(const Eigen::MatrixXd& matrix, const std::vector<std::uint8_t>& marked);
Eigen::VectorXd restricted(const Eigen::VectorXd& vector, const std::vector<std::uint8_t>& marked);
/// A vector with these values at the marked unknowns and zero elsewhere.
Eigen::VectorXd extended(const Eigen::VectorXd& vector, const std::vector<std::uint8_t>& marked);

/// A bar of cubes along x, each cut into six tetrahedra, with every node moved at random by up to `jitter` of the
/// spacing in each direction. Elements in the half of greater x belong to region 1, which is 4 times as stiff and 1.5
/// times as dense as region 0.
ReferenceSolid jittered_bar(const std::array<int, 3>& cells, double spacing, double jitter, unsigned seed);
/// Fixes the nodes of the first cross-section of a jittered bar.
void fix_first_section(ReferenceSolid& solid, const std::array<int, 3>& cells);

Eigen::VectorXd as_vector(std::span<const Point> points);
std::vector<Point> as_points(const Eigen::VectorXd& vector);
/// Uniform random numbers in [-amplitude, amplitude].
Eigen::VectorXd random_vector(Eigen::Index size, double amplitude, unsigned seed);
/// The points of `positions` turned by a rotation about the origin, then moved.
Eigen::VectorXd moved(const Eigen::VectorXd& positions, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& shift);
Eigen::Vector3d total_force(const Eigen::VectorXd& force);
Eigen::Vector3d total_torque(const Eigen::VectorXd& positions, const Eigen::VectorXd& force);

}  // namespace lancet::test
