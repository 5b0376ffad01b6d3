#pragma once

#include <cstdint>

namespace lancet::kernels {

/// Edge blocks between nodes of the same aggregate, seen by the aggregate's rigid motions.
template <class Real>
struct CoarseDiagonalArguments {
    const std::int32_t* block_chunk_begin;  ///< this and the next three: of a RowPattern of content upper_edges
    const std::int32_t* chunk_entry_begin;
    const std::int32_t* row;
    const std::int32_t* column;
    const Real* values;             ///< [entry][row-major 3 x 3 entry][lane]
    const std::int32_t* aggregate;  ///< [node], -1 at fixed nodes
    const Real* offset;             ///< xyz_ position of each node from the centre of its aggregate
    double* sums;  ///< [aggregate][coarse_diagonal_sums], added to: row-major coupling of translation with rotation
                   ///< (9), then the symmetric rotation block xx, yy, zz, xy, xz, yz
};
inline constexpr int coarse_diagonal_sums = 15;

/// Kernels of the coarse space's matrix.
template <class Real>
struct CoarseKernels {
    /// For a rigid motion (t, w) of an aggregate, an edge from i to j inside it has the difference d = w x (r_j - r_i),
    /// and pulls with K d at i and -K^T d at j: adds up the forces and torques that the unit motions cause.
    void (*diagonal)(const CoarseDiagonalArguments<Real>& arguments, int block);
};

}  // namespace lancet::kernels
