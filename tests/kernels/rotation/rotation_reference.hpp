#pragma once

#include <Eigen/Dense>

namespace lancet::kernels::test {

/// The rotation that maximises tr(R^T F), from a singular value decomposition in long double.
struct RotationReference {
    Eigen::Matrix3d rotation;
    double largest_trace;  ///< s1 + s2 +- s3
    double size;           ///< s1
    double condition;      ///< how much a relative error of F is magnified in R: 2 s1 / (s2 +- s3)
};

RotationReference rotation_reference(const Eigen::Matrix3d& f);

/// Uniform over all rotations for four normally distributed numbers.
Eigen::Quaterniond random_rotation(unsigned seed);

}  // namespace lancet::kernels::test
