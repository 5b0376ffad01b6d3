#pragma once

#include <cstdint>

#include <Eigen/Core>

// Includes Eigen, which users of the library need not have: for sources alone.
namespace lancet::runtime {

/// The rigid motions of one aggregate: three translations, and three rotations about its centre.
inline constexpr int rigid_motions = 6;

using RigidVector = Eigen::Matrix<double, rigid_motions, 1>;
using RigidMatrix = Eigen::Matrix<double, rigid_motions, rigid_motions>;

/// [r]x: the matrix of the cross product with r.
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& r) {
    Eigen::Matrix3d m;
    m << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
    return m;
}

/// A node of an xyz_ nodal vector.
template <class Real>
Eigen::Vector3d nodal_vector(const Real* xyz, std::int32_t node) {
    const Real* at = xyz + 4 * static_cast<std::int64_t>(node);
    return {static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])};
}

}  // namespace lancet::runtime
