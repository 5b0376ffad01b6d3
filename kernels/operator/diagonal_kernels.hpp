#pragma once

#include <cstdint>

#include "lancet/kernels/element/tetrahedron_kernels.hpp"

namespace lancet::kernels {

/// Three of the six numbers of a symmetric diagonal block, as many as a nodal vector carries.
enum class DiagonalPart {
    axial,  ///< xx, yy, zz
    mixed   ///< xy, xz, yz
};

/// The elements' shares of the diagonal blocks of the step matrix, scattered like a force.
template <class Real>
struct ElementDiagonalArguments {
    const std::int32_t* block_batch_begin;
    const std::int32_t* targets;
    const Real* rest;       ///< as ElementBatches::rest: lambda / mu is read; not read for element blocks
    const Real* rotated;    ///< rotated gradients or element blocks, in the layout below
    const Real* pair_mass;  ///< as ElementBatches::pair_mass; nullptr for a lumped mass, which is nodal
    Real* buffer;           ///< xyz_ buffer of the elements' scatter plan, added to
    Real stiffness_factor;
    Real mass_factor;
    GradientLayout layout;
    DiagonalPart part;
    bool exclusive_slots;
};

/// Inversion of the diagonal blocks into the form that the vector kernels apply.
template <class Real>
struct InvertDiagonalArguments {
    const std::int32_t* block_begin;
    const Real* buffer;  ///< [node] as xyz_: the part that has been scattered last
    const Real* mass;    ///< [node], added to xx, yy, zz
    Real* inverse;       ///< [node / width][6][lane]
    bool blocks;         ///< true: 3 x 3 blocks; false: their diagonals alone (Jacobi)
};

/// Kernels of the diagonal blocks: K_ii = V ((lambda + mu) b'_i b'_i^T + mu |b'_i|^2 1) for rotated gradients b', minus
/// the sum of the blocks of the edges at i for element blocks. As a nodal vector carries three numbers, `scatter` and
/// merging run for the axial part, `keep` stores it in `inverse`, and where blocks are wanted `scatter` runs again for
/// the mixed part, before `invert`.
template <class Real>
struct DiagonalKernels {
    void (*scatter)(const ElementDiagonalArguments<Real>& arguments, int block);
    void (*keep)(const InvertDiagonalArguments<Real>& arguments, int block);
    /// Nodes without stiffness and mass get zero.
    void (*invert)(const InvertDiagonalArguments<Real>& arguments, int block);
};

}  // namespace lancet::kernels
