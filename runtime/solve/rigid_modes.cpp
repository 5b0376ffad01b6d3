#include "lancet/runtime/solve/rigid_modes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

#include "lancet/runtime/solve/block_loop.hpp"

namespace lancet::runtime {

using Eigen::Matrix3d;
using Eigen::Vector3d;

template <class Real>
RigidModes<Real>::RigidModes(const kernels::NodeNumbering& numbering, const Aggregates& aggregates)
    : numbering_(&numbering),
      aggregates_(&aggregates),
      offset_(static_cast<std::size_t>(numbering.node_count) * 4),
      change_(static_cast<std::size_t>(numbering.blocks())) {}

template <class Real>
void RigidModes<Real>::resize(int aggregates) {
    basis_.assign(static_cast<std::size_t>(aggregates), RigidMatrix::Zero());
}

template <class Real>
void RigidModes<Real>::clear() {
    for (RigidMatrix& basis : basis_) basis.setZero();
}

template <class Real>
void RigidModes<Real>::set(Scheduler& scheduler, const double* positions) {
    scheduler.for_each_block(numbering_->blocks(), [&](int block) {
        const bool is_left_out = numbering_->sleeping.leave_out(block);
        aggregates_->for_each_of_block(block, [&](std::int32_t a) {
            if (!aggregates_->is_leader(a)) return;
            if (is_left_out) {
                basis_[static_cast<std::size_t>(a)].setZero();
            } else {
                set_leader(a, positions);
            }
        });
    });
}

template <class Real>
void RigidModes<Real>::set_leader(std::int32_t leader, const double* positions) {
    Vector3d centre = Vector3d::Zero();
    int count = 0;
    bool sleeps = false;
    aggregates_->for_each_node_led(leader, [&](std::int32_t node) {
        centre += nodal_vector(positions, node);
        sleeps = sleeps || numbering_->sleeping.has(node);
        ++count;
    });
    centre /= std::max(count, 1);
    Matrix3d inertia = Matrix3d::Zero();
    aggregates_->for_each_node_led(leader, [&](std::int32_t node) {
        const std::int64_t at = 4 * static_cast<std::int64_t>(node);
        const Vector3d r = nodal_vector(positions, node) - centre;
        for (int axis = 0; axis < 3; ++axis) offset_[at + axis] = static_cast<Real>(r[axis]);
        inertia += r.squaredNorm() * Matrix3d::Identity() - r * r.transpose();
    });
    // Rotations about principal axes of no extent move nothing: a node alone has none, collinear nodes two.
    RigidMatrix& basis = basis_[static_cast<std::size_t>(leader)];
    basis.setZero();
    if (count == 0 || sleeps) return;
    basis.topLeftCorner<3, 3>().diagonal().setConstant(1 / std::sqrt(std::max(count, 1)));
    Eigen::SelfAdjointEigenSolver<Matrix3d> axes;
    axes.computeDirect(inertia);
    // Offsets below the rounding of the positions are no extent at all.
    const double rounding = 64 * std::numeric_limits<double>::epsilon() * centre.cwiseAbs().maxCoeff();
    const double rank_limit = std::max(1e-8 * axes.eigenvalues().maxCoeff(), count * rounding * rounding);
    for (int k = 0; k < 3; ++k) {
        const double moment = axes.eigenvalues()[k];
        if (moment > rank_limit && moment > 0 && std::isfinite(moment)) {
            basis.block<3, 1>(3, 3 + k) = axes.eigenvectors().col(k) / std::sqrt(moment);
        }
    }
}

template <class Real>
double RigidModes<Real>::change_of_block(int block, const double* positions) const {
    double largest = 0;
    aggregates_->for_each_of_block(block, [&](std::int32_t a) {
        if (!aggregates_->is_leader(a)) return;
        // sum |d - mean d|^2 for d = x - r' is sum |d|^2 - |sum d|^2 / n, since the offsets r' have mean zero.
        Vector3d origin = Vector3d::Zero(), sum = Vector3d::Zero();
        double squares = 0, size = 0;
        int count = 0;
        aggregates_->for_each_node_led(a, [&](std::int32_t node) {
            const Vector3d r = nodal_vector(offset_.data(), node), x = nodal_vector(positions, node);
            if (count++ == 0) origin = x;
            const Vector3d d = x - origin - r;
            sum += d;
            squares += d.squaredNorm();
            size += r.squaredNorm();
        });
        const double moved = squares - sum.squaredNorm() / std::max(count, 1);
        if (size > 0) largest = std::max(largest, moved / size);
        if (!std::isfinite(moved)) largest = std::numeric_limits<double>::infinity();
    });
    return largest;
}

template <class Real>
double RigidModes<Real>::change(Scheduler& scheduler, const double* positions) {
    if (change_.empty()) return 0;  // no free node
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        change_[static_cast<std::size_t>(block)] = change_of_block(block, positions);
    });
    return std::sqrt(largest_of_awake_blocks(*numbering_, change_));
}

template class RigidModes<float>;
template class RigidModes<double>;

}  // namespace lancet::runtime
