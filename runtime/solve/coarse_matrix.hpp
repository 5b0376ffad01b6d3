#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lancet/runtime/schedule/scheduler.hpp"
#include "lancet/runtime/solve/aggregates.hpp"
#include "lancet/runtime/solve/rigid_motion.hpp"
#include "lancet/runtime/solve/row_operators.hpp"

namespace lancet::runtime {

/// What two aggregates have to do with each other by the edges of one block of nodes; the first owns their rows.
struct AggregatePair {
    std::int32_t first;
    std::int32_t second;
    int edges;                    ///< of elements
    RigidMatrix coupling;         ///< (first, second)
    RigidMatrix second_diagonal;  ///< a share of (second, second)
};

/// The matrix Z^T A Z of the rigid motions of aggregates, by its 6 x 6 blocks: one for each aggregate, one for each
/// pair of neighbours and block of nodes. It comes from the edge blocks of A in one sweep over the edges.
template <class Real>
class CoarseMatrix {
  public:
    /// `edges` must be of content upper_edges. All must outlive it. The pairs are those of the present aggregates.
    CoarseMatrix(const kernels::KernelSet<Real>& kernels, const BlockMatrix<Real>& edges,
                 const kernels::NodeNumbering& numbering, const Aggregates& aggregates);

    /// Makes places for so many aggregates.
    void resize(int aggregates);
    /// Sets the aggregates' own blocks to zero.
    void clear();
    /// Finds the pairs of a block of nodes anew, where its edges or the aggregates that it borders on have changed.
    void take_up_edges(int block);
    /// The blocks whose aggregates the pairs of a block of nodes are of.
    std::vector<int> borders(int block) const;

    /// How many edges the aggregates have in common, pair by pair.
    std::vector<Aggregates::Link> links() const;

    /// `offset`: xyz_, see RigidModes; `scaled_mass`: nodal masses times their factor. What follows another aggregate
    /// is added to its block.
    void assemble(Scheduler& scheduler, const Real* offset, const Real* scaled_mass);

    /// [aggregate]
    const std::vector<RigidMatrix>& diagonal() const noexcept { return diagonal_; }
    std::vector<RigidMatrix>& diagonal() noexcept { return diagonal_; }
    /// [block of nodes]. Those between what moves as one are in its diagonal, too.
    const std::vector<std::vector<AggregatePair>>& pairs() const noexcept { return pairs_; }
    std::vector<std::vector<AggregatePair>>& pairs() noexcept { return pairs_; }

    std::size_t bytes() const noexcept;

  private:
    /// An edge between two aggregates, or between an aggregate and the ground.
    struct CrossingEdge {
        std::int32_t value;  ///< entry * 9 * width + lane
        std::int32_t row;
        std::int32_t column;
        std::int32_t pair;  ///< of the block's pairs; -1: ground
    };
    void add_inside(const Real* offset, const Real* scaled_mass, int block);
    void add_crossing(const Real* offset, int block);
    /// What a block has of the matrix is nothing.
    void clear(int block);
    void accumulate(const Real* offset, const Real* scaled_mass, int block);

    const kernels::KernelSet<Real>* kernels_;
    const BlockMatrix<Real>* edges_;
    const kernels::NodeNumbering* numbering_;
    const Aggregates* aggregates_;
    std::vector<std::vector<CrossingEdge>> crossing_;  ///< [block]
    std::vector<std::vector<AggregatePair>> pairs_;    ///< [block]
    std::vector<double> inside_;                       ///< [aggregate][kernels::coarse_diagonal_sums]
    std::vector<RigidMatrix> diagonal_;                ///< [aggregate]
};

}  // namespace lancet::runtime
