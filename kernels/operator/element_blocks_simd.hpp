#pragma once

#include "lancet/kernels/element/hyperelastic_kernels.hpp"
#include "lancet/kernels/element/tetrahedron_geometry_simd.hpp"
#include "lancet/kernels/rotation/symmetric3.hpp"

namespace lancet::kernels {

/// Block K_ij, i < j, of a batch of GradientLayout::element_blocks.
template <class P>
LANCET_INLINE Matrix3<P> load_element_block(const typename P::Real* blocks, std::int64_t batch, int i, int j) {
    return load_matrix<P>(blocks + (batch * element_block_entries + 9 * element_block_index(i, j)) * P::width);
}

/// K d of a batch of elements on corners 1, 2, 3, from the differences d of their displacements to corner 0: on corner
/// i, K_ij (d_j - d_i) summed over the edges. Corner 0 takes minus their sum, for so do the rows of K.
template <class P>
LANCET_INLINE Corners<P> multiply_element_blocks(const typename P::Real* blocks, std::int64_t batch,
                                                 const Corners<P>& d) {
    Corners<P> f;
    for (int i = 0; i < 3; ++i) {
        const Vector3<P> pull = multiply_transposed(load_element_block<P>(blocks, batch, 0, i + 1), d.of[i]);
        f.of[i] = {-pull.x, -pull.y, -pull.z};
    }
    for (int i = 0; i < 3; ++i) {
        for (int j = i + 1; j < 3; ++j) {
            const Matrix3<P> k = load_element_block<P>(blocks, batch, i + 1, j + 1);
            const Vector3<P> e{d.of[j].x - d.of[i].x, d.of[j].y - d.of[i].y, d.of[j].z - d.of[i].z};
            const Vector3<P> on_i = multiply(k, e), on_j = multiply_transposed(k, e);
            f.of[i] = {f.of[i].x + on_i.x, f.of[i].y + on_i.y, f.of[i].z + on_i.z};
            f.of[j] = {f.of[j].x - on_j.x, f.of[j].y - on_j.y, f.of[j].z - on_j.z};
        }
    }
    return f;
}

/// The diagonal blocks K_ii = -sum_j K_ij of the four corners of a batch.
template <class P>
LANCET_INLINE void load_diagonal_blocks(const typename P::Real* blocks, std::int64_t batch,
                                        Symmetric3<P> (&diagonal)[4]) {
    const P zero(typename P::Real(0));
    for (int i = 0; i < 4; ++i) diagonal[i] = {zero, zero, zero, zero, zero, zero};
    for (int i = 0; i < 4; ++i) {
        for (int j = i + 1; j < 4; ++j) {
            // Of the sum only the symmetric part is left but for rounding, so the transposed block adds the same.
            const Symmetric3<P> k = symmetric_part(load_element_block<P>(blocks, batch, i, j));
            for (Symmetric3<P>* end : {&diagonal[i], &diagonal[j]}) {
                end->xx -= k.xx;
                end->yy -= k.yy;
                end->zz -= k.zz;
                end->xy -= k.xy;
                end->xz -= k.xz;
                end->yz -= k.yz;
            }
        }
    }
}

/// Adds to k in every lane the block of one element for a pair of corners, named by 4 * (4 * slot + corner).
template <class P>
LANCET_INLINE void add_incident_blocks(const typename P::Real* blocks, const std::int32_t* row_corners,
                                       const std::int32_t* column_corners, P (&k)[3][3]) {
    using Real = typename P::Real;
    constexpr int W = P::width;
    Real lanes[9][W];
    for (int lane = 0; lane < W; ++lane) {
        const std::int64_t slot = row_corners[lane] >> 4;
        const int i = (row_corners[lane] >> 2) & 3;
        const int j = (column_corners[lane] >> 2) & 3;
        const Real* element = blocks + (slot / W) * element_block_entries * W + slot % W;
        if (i == j) {
            for (int entry = 0; entry < 9; ++entry) lanes[entry][lane] = Real(0);
            for (int other = 0; other < 4; ++other) {
                if (other == i) continue;
                const bool upper = i < other;
                const Real* block =
                    element + 9 * W * (upper ? element_block_index(i, other) : element_block_index(other, i));
                for (int row = 0; row < 3; ++row) {
                    for (int column = 0; column < 3; ++column) {
                        lanes[3 * row + column][lane] -= block[(upper ? 3 * row + column : 3 * column + row) * W];
                    }
                }
            }
        } else {
            const bool upper = i < j;
            const Real* block = element + 9 * W * (upper ? element_block_index(i, j) : element_block_index(j, i));
            const int row_stride = upper ? 3 * W : W, column_stride = upper ? W : 3 * W;
            for (int row = 0; row < 3; ++row) {
                for (int column = 0; column < 3; ++column) {
                    lanes[3 * row + column][lane] = block[row * row_stride + column * column_stride];
                }
            }
        }
    }
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) k[row][column] += P::load(lanes[3 * row + column]);
    }
}

}  // namespace lancet::kernels
