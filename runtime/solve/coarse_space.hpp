#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "lancet/runtime/solve/aggregates.hpp"
#include "lancet/runtime/solve/row_operators.hpp"

namespace lancet::runtime {

/// The coarse matrix with its modes and factors.
struct CoarseMatrices;

/// The rigid-body modes of the aggregates of a numbering, as an additive coarse space: correction = Z (Z^T A Z)^-1 Z^T
/// r. A cut in place severs aggregates: their pieces have modes of their own (Aggregates).
///
/// Z holds translations and rotations about each aggregate's current centre, orthonormalised; modes that an aggregate
/// does not have (one node, collinear or collapsed nodes) are left out. Z^T A Z comes from the edge blocks of A in one
/// sweep over the edges. It is scaled by its diagonal and factorised in double: densely up to `dense_limit` unknowns,
/// sparsely above.
template <class Real>
class CoarseSpace {
  public:
    static constexpr int modes = 6;
    static constexpr int dense_limit = 120;

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

    int unknowns() const noexcept;
    std::size_t bytes() const noexcept;

    /// The state that a bit-exact continuation needs.
    void save(std::vector<double>& numbers) const;
    /// Reads back what save wrote, from the front of `numbers`, which it removes.
    void restore(std::span<const double>& numbers);

  private:
    /// How many aggregates and pieces there are modes for.
    int counted() const noexcept { return unknowns() / modes; }
    void take_up_edges(int block);
    void take_up_aggregates();
    void set_modes(const double* positions, int block);
    void accumulate(const Real* scaled_mass, int block);
    bool factorise();

    const kernels::KernelSet<Real>* kernels_;
    const kernels::NodeNumbering* numbering_;
    const BlockMatrix<Real>* edges_;
    Aggregates aggregates_;
    kernels::AlignedVector<Real> offset_;  ///< xyz_, from the centre of the aggregate or piece
    std::vector<double> restricted_;
    std::vector<Real> correction_;
    std::vector<double> change_;  ///< [block]
    bool is_fresh_ = false;
    std::unique_ptr<CoarseMatrices> matrices_;
};

}  // namespace lancet::runtime
