#pragma once

#include "lancet/kernels/rotation/matrix3.hpp"
#include "lancet/kernels/simd/nodes.hpp"

namespace lancet::kernels {

/// A symmetric 3 x 3 matrix in every lane.
template <class P>
struct Symmetric3 {
    P xx, yy, zz, xy, xz, yz;
};

/// All nine entries.
template <class P>
LANCET_INLINE Matrix3<P> to_matrix(const Symmetric3<P>& s) {
    return {{{s.xx, s.xy, s.xz}, {s.xy, s.yy, s.yz}, {s.xz, s.yz, s.zz}}};
}

/// (A + A^T) / 2.
template <class P>
LANCET_INLINE Symmetric3<P> symmetric_part(const Matrix3<P>& a) {
    const P half(typename P::Real(0.5));
    return {a.entry[0][0],
            a.entry[1][1],
            a.entry[2][2],
            half * (a.entry[0][1] + a.entry[1][0]),
            half * (a.entry[0][2] + a.entry[2][0]),
            half * (a.entry[1][2] + a.entry[2][1])};
}

/// The symmetric part of a^T b.
template <class P>
LANCET_INLINE Symmetric3<P> symmetric_part_of_product(const Matrix3<P>& a, const Matrix3<P>& b) {
    return symmetric_part(multiply_transposed(a, b));
}

template <class P>
LANCET_INLINE Vector3<P> multiply(const Symmetric3<P>& s, const Vector3<P>& v) {
    return {fma(s.xx, v.x, fma(s.xy, v.y, s.xz * v.z)), fma(s.xy, v.x, fma(s.yy, v.y, s.yz * v.z)),
            fma(s.xz, v.x, fma(s.yz, v.y, s.zz * v.z))};
}

/// a where the mask is true, b elsewhere.
template <class P>
LANCET_INLINE Symmetric3<P> select(Mask<typename P::Isa, typename P::Real> mask, const Symmetric3<P>& a,
                                   const Symmetric3<P>& b) {
    return {select(mask, a.xx, b.xx), select(mask, a.yy, b.yy), select(mask, a.zz, b.zz),
            select(mask, a.xy, b.xy), select(mask, a.xz, b.xz), select(mask, a.yz, b.yz)};
}

}  // namespace lancet::kernels
