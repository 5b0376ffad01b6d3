#pragma once

#include <cstdint>

#include "lancet/kernels/layout/element_batches.hpp"
#include "lancet/kernels/rotation/rotation_kernels.hpp"

namespace lancet::kernels {

/// What is kept of an element's stiffness between its evaluation and product or assembly: rotated gradients, from which
/// the blocks of an isotropic linear law follow, or the blocks themselves.
enum class GradientLayout {
    batches,        ///< rotated gradients [batch][9][lane], corners 1 to 3: what a matrix-free product streams
    corners,        ///< rotated gradients [4 * slot + corner] as x, y, z, lambda / mu: what assembly gathers
    element_blocks  ///< [batch][54][lane]: HyperelasticArguments::element_blocks, of any material and tangent
};

/// Where the buffer of a scatter plan is opened: own nodes and slots of each block.
struct ScatterView {
    const std::int32_t* block_begin;
    const std::int32_t* slot_begin;
    const std::int32_t* merge_begin;
    const ScatterPlan::Merge* merges;
    bool exclusive_slots;  ///< each slot is written once (node gather): stored, not added
};

/// The element batches and their state, as raw pointers into arrays that ElementBatches and its user own.
template <class Real>
struct TetrahedronArguments {
    const std::int32_t* block_batch_begin;
    const std::int32_t* nodes;
    const std::int32_t* targets;
    const Real* rest;
    const double* positions;  ///< xyz_ nodal vector, metres
    Real* quaternion;         ///< [batch][w, x, y, z][lane]; nullptr for a linear material: no rotation
    Real* rotated;            ///< sqrt(V mu) R grad phi, in the layout below; nullptr: not stored
    Real* force;              ///< xyz_ buffer of the scatter plan, newtons; nullptr where no force is wanted
    double* energy;           ///< [block] joules; nullptr where it is not wanted
    GradientLayout layout;    ///< batches or corners
    RotationMethod method;
    int rotation_steps;
    bool update_rotation;  ///< false: the rotated gradients are kept, and force and energy follow from them
    bool exclusive_slots;
};

/// Kernels of linear tetrahedra, over the batches of a block.
///
/// With b_j the gradients of the shape functions, F = sum_j x_j b_j^T and R its rotation, the corotated element is
/// linear elasticity in the rotated gradients b'_j = R b_j: G = sum_j x_j b'_j^T - 1 = F R^T - 1,
/// sigma = mu (G + G^T) + lambda tr(G) 1, force on corner i: -V sigma b'_i, energy V sigma : G / 2.
/// (Mueller and Gross 2004; the form without R in the product is that of rotated gradients.)
template <class Real>
struct TetrahedronKernels {
    /// Rotations, rotated gradients, elastic force (added to `force`) and energy, as asked for by the arguments.
    void (*elastic)(const TetrahedronArguments<Real>& arguments, int block);
};

}  // namespace lancet::kernels
