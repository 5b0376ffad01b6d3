#pragma once

#include "lancet/kernels/element/tetrahedron_kernels_simd.hpp"
#include "lancet/kernels/operator/diagonal_kernels.hpp"
#include "lancet/kernels/operator/element_blocks_simd.hpp"

namespace lancet::kernels {

/// The part that is asked for of K_ii of the four corners of a batch, times a factor, with their masses on the axes.
template <class P>
LANCET_INLINE void diagonal_shares(const ElementDiagonalArguments<typename P::Real>& a, std::int64_t batch, P factor,
                                   const P (&mass)[4], Vector3<P> (&share)[4]) {
    using Real = typename P::Real;
    constexpr int W = P::width;
    if (a.layout == GradientLayout::element_blocks) {
        Symmetric3<P> diagonal[4];
        load_diagonal_blocks(a.rotated, batch, diagonal);
        for (int corner = 0; corner < 4; ++corner) {
            const Symmetric3<P>& k = diagonal[corner];
            if (a.part == DiagonalPart::axial) {
                share[corner] = {fma(factor, k.xx, mass[corner]), fma(factor, k.yy, mass[corner]),
                                 fma(factor, k.zz, mass[corner])};
            } else {
                share[corner] = {factor * k.xy, factor * k.xz, factor * k.yz};
            }
        }
        return;
    }
    const Corners<P> b = a.layout == GradientLayout::batches ? load_corners<P>(a.rotated + batch * 9 * W)
                                                             : load_gradient_corners<P>(a.rotated + batch * 16 * W);
    const Vector3<P> total = b.sum();
    const Vector3<P> all[4] = {{-total.x, -total.y, -total.z}, b.of[0], b.of[1], b.of[2]};
    const P dyad = factor * (P(Real(1)) + P::load(a.rest + (batch * ElementBatches<Real>::rest_entries + 10) * W));
    for (int corner = 0; corner < 4; ++corner) {
        const Vector3<P>& g = all[corner];
        if (a.part == DiagonalPart::axial) {
            const P common = fma(factor, fma(g.z, g.z, fma(g.y, g.y, g.x * g.x)), mass[corner]);
            share[corner] = {fma(dyad * g.x, g.x, common), fma(dyad * g.y, g.y, common), fma(dyad * g.z, g.z, common)};
        } else {
            share[corner] = {dyad * g.x * g.y, dyad * g.x * g.z, dyad * g.y * g.z};
        }
    }
}

template <class P>
void scatter_diagonal(const ElementDiagonalArguments<typename P::Real>& a, int block) {
    using Real = typename P::Real;
    constexpr int W = P::width;
    const P factor(a.stiffness_factor);
    for (std::int64_t batch = a.block_batch_begin[block]; batch < a.block_batch_begin[block + 1]; ++batch) {
        // int rho phi_i^2 is the row sum, which is nodal, less the masses of the corner's pairs.
        P mass[4] = {P(Real(0)), P(Real(0)), P(Real(0)), P(Real(0))};
        if (a.pair_mass != nullptr) {
            for (std::size_t pair = 0; pair < 6; ++pair) {
                const P m = P(a.mass_factor) * P::load(a.pair_mass + (batch * 6 + static_cast<std::int64_t>(pair)) * W);
                for (const std::size_t corner : corner_pairs[pair]) mass[corner] = mass[corner] - m;
            }
        }
        Vector3<P> share[4];
        diagonal_shares(a, batch, factor, mass, share);
        for (int corner = 0; corner < 4; ++corner) {
            const std::int32_t* targets = a.targets + (batch * 4 + corner) * W;
            if (a.exclusive_slots) {
                store_nodes(a.buffer, targets, share[corner]);
            } else {
                add_to_nodes(a.buffer, targets, share[corner]);
            }
        }
    }
}

template <class P>
void keep_axial_part(const InvertDiagonalArguments<typename P::Real>& a, int block) {
    constexpr int W = P::width;
    for (std::int64_t node = a.block_begin[block]; node < a.block_begin[block + 1]; node += W) {
        const Vector3<P> axial = load_nodes<P>(a.buffer + 4 * node);
        axial.x.store(a.inverse + 6 * node);
        axial.y.store(a.inverse + 6 * node + W);
        axial.z.store(a.inverse + 6 * node + 2 * W);
    }
}

/// Inverts by the adjugates, scaled so that neither overflow nor underflow occurs.
template <class P>
void invert_diagonal(const InvertDiagonalArguments<typename P::Real>& a, int block) {
    using Real = typename P::Real;
    constexpr int W = P::width;
    const P one(Real(1)), zero(Real(0));
    for (std::int64_t node = a.block_begin[block]; node < a.block_begin[block + 1]; node += W) {
        Real* stored = a.inverse + 6 * node;
        const P mass = P::load(a.mass + node);
        P xx = P::load(stored) + mass, yy = P::load(stored + W) + mass, zz = P::load(stored + 2 * W) + mass;
        const P size = xx + yy + zz;
        const auto is_used = size > zero;
        const P factor = one / select(is_used, size, one);
        P inverse[6];
        if (a.blocks) {
            const Vector3<P> mixed = load_nodes<P>(a.buffer + 4 * node);
            xx *= factor;
            yy *= factor;
            zz *= factor;
            const P xy = factor * mixed.x, xz = factor * mixed.y, yz = factor * mixed.z;
            const P cxx = fnma(yz, yz, yy * zz), cxy = fnma(xy, zz, xz * yz), cxz = fnma(xz, yy, xy * yz);
            const P determinant = fma(xz, cxz, fma(xy, cxy, xx * cxx));
            const P scaled = factor / select(is_used, determinant, one);
            inverse[0] = cxx * scaled;
            inverse[1] = fnma(xz, xz, xx * zz) * scaled;
            inverse[2] = fnma(xy, xy, xx * yy) * scaled;
            inverse[3] = cxy * scaled;
            inverse[4] = cxz * scaled;
            inverse[5] = fnma(xx, yz, xy * xz) * scaled;
        } else {
            inverse[0] = one / select(is_used, xx, one);
            inverse[1] = one / select(is_used, yy, one);
            inverse[2] = one / select(is_used, zz, one);
            inverse[3] = inverse[4] = inverse[5] = zero;
        }
        for (int c = 0; c < 6; ++c) select(is_used, inverse[c], zero).store(stored + c * W);
    }
}

template <class P>
constexpr DiagonalKernels<typename P::Real> make_diagonal_kernels() {
    return {.scatter = &scatter_diagonal<P>, .keep = &keep_axial_part<P>, .invert = &invert_diagonal<P>};
}

}  // namespace lancet::kernels
