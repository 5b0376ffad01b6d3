#pragma once

#include <cstdint>

#include "lancet/kernels/layout/element_batches.hpp"
#include "lancet/kernels/material/material_model.hpp"

namespace lancet::kernels {

/// The edge blocks that `tangent` writes for an element: K_01, K_02, K_03, K_12, K_13, K_23 of its corners. The others
/// follow: K_ji = K_ij^T, and the rows of K add up to zero.
inline constexpr int element_block_count = 6;
/// Numbers per lane of an array of element blocks.
inline constexpr int element_block_entries = 9 * element_block_count;

/// The place of block K_ij, i < j, among those of its element.
constexpr int element_block_index(int i, int j) {
    return i == 0 ? j - 1 : i + j;
}

/// The element batches of a body and its state, as raw pointers into arrays that their owners hold.
template <class Real>
struct HyperelasticArguments {
    const std::int32_t* block_batch_begin;
    const std::int32_t* nodes;
    const std::int32_t* targets;
    const Real* rest;
    const double* positions;  ///< xyz_ nodal vector, metres
    const double* start;      ///< evaluate: positions at the start of a step of which `positions` are the middle: the
                              ///< force is that of the average stress of the step, for materials that have one (their
                              ///< energy is that of the middle); nullptr: of the stress at `positions`
    Real* quaternion;         ///< [batch][w, x, y, z][lane] unit; start and result of the rotations of the corotational
                              ///< material; the others do not read it
    Real* force;              ///< evaluate: xyz_ buffer of the scatter plan, newtons; nullptr where no force is wanted
    double* energy;           ///< evaluate: [block] joules; nullptr where it is not wanted
    Real* element_blocks;     ///< tangent: [batch][block, row-major 3 x 3 entry: 54][lane], newtons per metre. Their
                              ///< readers want one batch of zeros more behind the last, which no kernel writes
    MaterialModel model;
    TangentKind tangent;  ///< has_tangent(model, tangent)
    int rotation_steps;   ///< Newton steps before the first test of convergence (RotationMethod::robust)
    bool exclusive_slots;
};

/// Kernels of linear tetrahedra of any material, over the batches of a block. With b_j the gradients of the shape
/// functions, F = sum_j x_j b_j^T and P = dW/dF: force on corner i: -V P b_i, energy V W, and column c of K_ij:
/// V (dP/dF : e_c b_j^T) b_i.
template <class Real>
struct HyperelasticKernels {
    /// Elastic force (added to `force`) and energy, as asked for by the arguments.
    void (*evaluate)(const HyperelasticArguments<Real>& arguments, int block);
    /// The edge blocks of the elements' stiffness; zero in padding. Not a number where the material has no such
    /// tangent.
    void (*tangent)(const HyperelasticArguments<Real>& arguments, int block);
};

}  // namespace lancet::kernels
