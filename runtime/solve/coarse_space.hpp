#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "lancet/runtime/schedule/scheduler.hpp"
#include "lancet/runtime/solve/row_operators.hpp"

namespace lancet::runtime {

/// The rigid-body modes of the aggregates of a numbering, as an additive coarse space: correction = Z (Z^T A Z)^-1 Z^T
/// r. A cut in place severs aggregates; for what comes of that, and which of it have modes of their own, see
/// Aggregates.
///
/// Z holds translations and rotations about each aggregate's current centre, orthonormalised; modes that an aggregate
/// does not have are left out (RigidModes). Z^T A Z is gathered by CoarseMatrix and solved with by CoarseFactor.
template <class Real>
class CoarseSpace {
  public:
    /// `edges` must be of content upper_edges.
    CoarseSpace(const kernels::KernelSet<Real>& kernels, const kernels::NodeNumbering& numbering,
                const BlockMatrix<Real>& edges);
    ~CoarseSpace();
    CoarseSpace(CoarseSpace&&) noexcept;

    /// The largest change of shape or orientation of an aggregate since the last refresh, relative to its size:
    /// sqrt(sum |r_i - r_i'|^2 / sum |r_i'|^2) with r_i the offsets from its centre. Infinite before the first refresh.
    double change(Scheduler& scheduler, const double* positions);

    /// Takes up that the edges of some blocks have changed, or the numbering has grown; a refresh comes next.
    void change(std::span<const int> blocks);

    /// Takes up modes at `positions` and the matrix from the edge blocks and scaled nodal masses. Returns false if the
    /// coarse matrix is not positive definite (the edge blocks are not finite, say); the correction is then zero.
    bool refresh(Scheduler& scheduler, const double* positions, const Real* scaled_mass);

    /// Replaces `restricted` (force and torque per aggregate) by the rigid motions `correction` of the coarse solution.
    void solve();

    /// For the vector kernels: where they put the restriction and read the correction.
    kernels::CoarseArguments<Real> arguments() noexcept;

    /// The vector kernels go by the ranges of aggregates. After restrict_residual: what the pieces of a block feel of
    /// the residual r (xyz_), which is taken from their aggregates.
    template <class Accumulate>
    void restrict_to_pieces(const Accumulate* r, int block);
    /// After precondition_with_coarse: the motion that the pieces have and their aggregates do not is added to z
    /// (xyz_); returns what r . z has more by that.
    template <class Accumulate>
    double move_pieces(const Accumulate* r, Real* z, int block) const;

    /// Of the coarse matrix.
    int unknowns() const noexcept;
    std::size_t bytes() const noexcept;

    /// The state that a bit-exact continuation needs.
    void save(std::vector<double>& numbers) const;
    /// Reads back what save wrote, from the front of `numbers`, which it removes.
    void restore(std::span<const double>& numbers);

  private:
    /// Aggregates, modes, matrix and factor: with types of Eigen, which users of the library need not have.
    struct Parts;

    /// Makes places for all aggregates and pieces, chooses which lead, and lays out the factor.
    void lay_out();
    bool factorise();

    const kernels::NodeNumbering* numbering_;
    std::vector<double> restricted_;
    std::vector<Real> correction_;
    bool is_fresh_ = false;
    std::unique_ptr<Parts> parts_;
};

}  // namespace lancet::runtime
