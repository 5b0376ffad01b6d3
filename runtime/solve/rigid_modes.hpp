#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "lancet/runtime/schedule/scheduler.hpp"
#include "lancet/runtime/solve/aggregates.hpp"
#include "lancet/runtime/solve/rigid_motion.hpp"

namespace lancet::runtime {

/// The rigid-body modes of aggregates at some positions: offsets of the nodes from the centres of their aggregates, and
/// what orthonormalises the motions of an aggregate, without those that move nothing (one node, collinear or collapsed
/// nodes). What follows another aggregate (see Aggregates) counts to it.
template <class Real>
class RigidModes {
  public:
    /// Both must outlive it.
    RigidModes(const kernels::NodeNumbering& numbering, const Aggregates& aggregates);

    /// Makes places for the modes of so many aggregates, which have none yet.
    void resize(int aggregates);
    /// Takes away all modes.
    void clear();
    /// Takes up the modes of all aggregates at `positions` (xyz_).
    void set(Scheduler& scheduler, const double* positions);
    /// How much an aggregate has changed since at most: see CoarseSpace::change.
    double change(Scheduler& scheduler, const double* positions);

    /// xyz_, from the centre of all that moves with the node.
    const kernels::AlignedVector<Real>& offset() const noexcept { return offset_; }
    kernels::AlignedVector<Real>& offset() noexcept { return offset_; }
    /// [aggregate] from orthonormal modes to motions; zero columns for modes that are left out. What follows another
    /// aggregate, or is asleep, has none.
    const std::vector<RigidMatrix>& basis() const noexcept { return basis_; }
    std::vector<RigidMatrix>& basis() noexcept { return basis_; }

    std::size_t bytes() const noexcept { return kernels::heap_bytes(offset_) + kernels::heap_bytes(basis_); }

  private:
    void set_leader(std::int32_t leader, const double* positions);
    double change_of_block(int block, const double* positions) const;

    const kernels::NodeNumbering* numbering_;
    const Aggregates* aggregates_;
    kernels::AlignedVector<Real> offset_;
    std::vector<RigidMatrix> basis_;
    std::vector<double> change_;  ///< [block]
};

}  // namespace lancet::runtime
