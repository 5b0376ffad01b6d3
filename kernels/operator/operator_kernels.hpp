#pragma once

#include <cstdint>

#include "lancet/kernels/element/tetrahedron_kernels.hpp"
#include "lancet/kernels/layout/row_pattern.hpp"

namespace lancet::kernels {

/// A product y = A z with the step matrix A = (1 + dt alpha) M + (dt^2 + dt beta) K of the free nodes. `z` is read at
/// every node (it is zero at fixed ones); `y` is the buffer of the scatter plan.
///
/// Each product also returns z . A z, exactly the quadratic form of what was added to y: conjugate gradients need it,
/// and over elements or edges it costs nothing and no second pass.
template <class Real>
struct ProductArguments {
    const Real* z;
    Real* y;
    double* quadratic;  ///< [block] z . A z
    bool exclusive_slots;
};

/// Opening of a block's part of the buffer: own nodes get the nodal mass term, slots become zero.
template <class Real>
struct OpenArguments {
    const std::int32_t* block_begin;
    const std::int32_t* slot_begin;
    const std::int32_t* slot_end;  ///< [block]
    const Real* mass;              ///< [node] nodal masses times their factor; nullptr: zero
    const Real* z;                 ///< read only with `mass`
    Real* y;
    double* quadratic;  ///< [block]; nullptr: not wanted
    bool clear_slots;
};

/// The elements as a matrix: K = sum over elements, from rotated gradients (mu, lambda folded in) or element blocks.
template <class Real>
struct MatrixFreeArguments {
    const std::int32_t* block_batch_begin;
    const std::int32_t* nodes;
    const std::int32_t* targets;
    const Real* rest;       ///< as ElementBatches::rest: lambda / mu is read; not read for element blocks
    const Real* rotated;    ///< rotated gradients or element blocks, in the layout below
    const Real* pair_mass;  ///< as ElementBatches::pair_mass, times the mass factor; nullptr: a lumped mass
    Real stiffness_factor;
    GradientLayout layout = GradientLayout::batches;  ///< batches or element_blocks
};

/// Sliced rows of 3 x 3 blocks.
template <class Real>
struct RowArguments {
    const std::int32_t* block_chunk_begin;
    const std::int32_t* chunk_entry_begin;
    const std::int32_t* row;
    const std::int32_t* row_target;
    const std::int32_t* column;
    const std::int32_t* column_target;
    const Real* values;  ///< [entry][row-major 3 x 3 entry][lane]
};

/// Gathers the blocks of a pattern from rotated gradients or element blocks.
template <class Real>
struct AssemblyArguments {
    const std::int32_t* block_chunk_begin;
    const std::int32_t* chunk_entry_begin;
    const std::int32_t* incidence_begin;
    const std::int32_t* incidence;
    const Real* rotated;     ///< rotated gradients or element blocks in the layout below, with a batch of zeros behind
                             ///< the last
    const Real* rest;        ///< as ElementBatches::rest; read only for GradientLayout::batches
    const Real* entry_mass;  ///< [entry][lane] added to the diagonal of each block; nullptr: none
    Real* values;            ///< [entry][9][lane]
    Real stiffness_factor;
    GradientLayout layout;
};

/// Products and assembly over the blocks of the numbering.
template <class Real>
struct OperatorKernels {
    void (*open)(const OpenArguments<Real>& arguments, int block);
    /// Adds to the block's nodes what other blocks, or its own slots, hold for them.
    void (*merge)(const std::int32_t* merge_begin, const ScatterPlan::Merge* merges, Real* y, int block);
    void (*matrix_free)(const ProductArguments<Real>& product, const MatrixFreeArguments<Real>& matrix, int block);
    /// y_i += K_ij (z_j - z_i) and y_j -= K_ij^T (z_j - z_i): one block serves both ends of an edge, because the rows
    /// of K add up to zero.
    void (*edge_blocks)(const ProductArguments<Real>& product, const RowArguments<Real>& matrix, int block);
    /// y_i += sum_j A_ij z_j.
    void (*block_rows)(const ProductArguments<Real>& product, const RowArguments<Real>& matrix, int block);
    /// K_ij = sum over elements of V (lambda b'_i b'_j^T + mu b'_j b'_i^T + mu (b'_i . b'_j) 1), or of their blocks.
    void (*assemble)(const AssemblyArguments<Real>& arguments, int block);
};

}  // namespace lancet::kernels
