#pragma once

#include <cstdint>

namespace lancet::kernels {

/// The vectors of a conjugate-gradient iteration. `Real` is the scalar of the operator and the preconditioner,
/// `Accumulate` that of the solution and the residual. All are xyz_ nodal vectors.
template <class Real, class Accumulate>
struct ConjugateGradientArguments {
    const std::int32_t* block_begin;
    const Real* w;                 ///< A z
    Real* z;                       ///< preconditioned residual
    Accumulate* p;                 ///< direction
    Accumulate* s;                 ///< A p, by recurrence
    Accumulate* x;                 ///< solution
    Accumulate* r;                 ///< residual
    const Real* inverse_diagonal;  ///< [node / width][xx, yy, zz, xy, xz, yz][lane]; nullptr: identity
    Accumulate alpha;
    Accumulate beta;
    double* r_dot_z;  ///< [block]
    double* r_dot_r;  ///< [block]
};

/// Rigid-body modes of the aggregates: translations and rotations about each aggregate's centre.
template <class Real>
struct CoarseArguments {
    const std::int32_t* block_aggregate_begin;
    const std::int32_t* aggregate_begin;
    const Real* offset;      ///< xyz_ position of each node from the centre of its aggregate; zero at unused nodes
    double* restricted;      ///< [aggregate][6] force and torque of the residual
    const Real* correction;  ///< [aggregate][6] translation and rotation to be added
};

/// Vector passes of conjugate gradients, over the blocks of the numbering. All are fused: a block's part of every
/// vector is read once.
template <class Real, class Accumulate>
struct VectorKernels {
    /// p = z + beta p, s = w + beta s, x += alpha p, r -= alpha s (Chronopoulos and Gear 1989).
    void (*update)(const ConjugateGradientArguments<Real, Accumulate>& arguments, int block);
    /// z = B r and the products r . z, r . r, where B is the block-diagonal inverse.
    void (*precondition)(const ConjugateGradientArguments<Real, Accumulate>& arguments, int block);
    /// `update`, then `precondition`, in one pass.
    void (*update_and_precondition)(const ConjugateGradientArguments<Real, Accumulate>& arguments, int block);
    /// The force and torque of the residual on each aggregate.
    void (*restrict_residual)(const CoarseArguments<Real>& coarse,
                              const ConjugateGradientArguments<Real, Accumulate>& arguments, int block);
    /// z = B r + the rigid motion of the node's aggregate, and the products r . z, r . r.
    void (*precondition_with_coarse)(const CoarseArguments<Real>& coarse,
                                     const ConjugateGradientArguments<Real, Accumulate>& arguments, int block);
};

}  // namespace lancet::kernels
