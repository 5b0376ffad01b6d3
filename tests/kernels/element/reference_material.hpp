#pragma once

#include <Eigen/Dense>

#include "lancet/kernels/material/material_model.hpp"

namespace lancet::test {

/// A 9 x 9 matrix on 3 x 3 matrices, whose entries are numbered row by row.
using Tangent = Eigen::Matrix<double, 9, 9>;

/// A hyperelastic law at one point written from its textbook form in double: what the library's pointwise functions and
/// elements are compared with.
struct PointwiseReference {
    kernels::MaterialModel model;
    double lambda;
    double mu;

    /// W(F).
    double energy(const Eigen::Matrix3d& f) const;
    /// dW/dF.
    Eigen::Matrix3d stress(const Eigen::Matrix3d& f) const;
    /// d^2 W / dF^2, or what stands for it.
    Tangent tangent(const Eigen::Matrix3d& f, kernels::TangentKind kind) const;
};

/// The proper rotation that maximises tr(R^T F), from a two-sided Jacobi singular value decomposition.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& f);

/// The singular values of F from the largest to the smallest, the last one negative where det F < 0.
Eigen::Vector3d proper_stretches(const Eigen::Matrix3d& f);

/// The symmetric matrix with its negative eigenvalues set to zero.
Tangent clamped(const Tangent& symmetric);

/// The entries of a matrix row by row, and back.
Eigen::Matrix<double, 9, 1> flattened(const Eigen::Matrix3d& a);
Eigen::Matrix3d unflattened(const Eigen::Matrix<double, 9, 1>& a);

}  // namespace lancet::test
