#pragma once

#include "lancet/kernels/rotation/matrix3.hpp"

namespace lancet::kernels {

/// A quaternion w + x i + y j + z k in every lane; of unit length it is a rotation.
template <class P>
struct Quaternion {
    P w, x, y, z;
};

template <class P>
LANCET_INLINE Quaternion<P> identity_quaternion() {
    using Real = typename P::Real;
    return {P(Real(1)), P(Real(0)), P(Real(0)), P(Real(0))};
}

/// Reads [w, x, y, z][lane].
template <class P>
LANCET_INLINE Quaternion<P> load_quaternion(const typename P::Real* source) {
    return {P::load(source), P::load(source + P::width), P::load(source + 2 * P::width),
            P::load(source + 3 * P::width)};
}

/// Writes [w, x, y, z][lane].
template <class P>
LANCET_INLINE void store_quaternion(typename P::Real* destination, const Quaternion<P>& q) {
    q.w.store(destination);
    q.x.store(destination + P::width);
    q.y.store(destination + 2 * P::width);
    q.z.store(destination + 3 * P::width);
}

/// a b: rotates by b, then by a.
template <class P>
LANCET_INLINE Quaternion<P> multiply(const Quaternion<P>& a, const Quaternion<P>& b) {
    return {fnma(a.z, b.z, fnma(a.y, b.y, fnma(a.x, b.x, a.w * b.w))),
            fnma(a.z, b.y, fma(a.y, b.z, fma(a.x, b.w, a.w * b.x))),
            fma(a.z, b.x, fma(a.y, b.w, fnma(a.x, b.z, a.w * b.y))),
            fma(a.z, b.w, fnma(a.y, b.x, fma(a.x, b.y, a.w * b.z)))};
}

template <class P>
LANCET_INLINE Quaternion<P> conjugate(const Quaternion<P>& q) {
    return {q.w, -q.x, -q.y, -q.z};
}

template <class P>
LANCET_INLINE P squared_length(const Quaternion<P>& q) {
    return fma(q.z, q.z, fma(q.y, q.y, fma(q.x, q.x, q.w * q.w)));
}

/// q / |q|, to rounding; |q|^2 must be a normal number.
template <class P>
LANCET_INLINE Quaternion<P> normalise(const Quaternion<P>& q) {
    const P factor = P(typename P::Real(1)) / sqrt(squared_length(q));
    return {q.w * factor, q.x * factor, q.y * factor, q.z * factor};
}

/// a where the mask is true, b elsewhere.
template <class P>
LANCET_INLINE Quaternion<P> select(Mask<typename P::Isa, typename P::Real> mask, const Quaternion<P>& a,
                                   const Quaternion<P>& b) {
    return {select(mask, a.w, b.w), select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

/// |q|^2 R: the rotation matrix times the squared length, a rotation matrix if q is of unit length.
template <class P>
LANCET_INLINE Matrix3<P> to_matrix(const Quaternion<P>& q) {
    const P two(typename P::Real(2));
    const P x2 = two * q.x;
    const P y2 = two * q.y;
    const P z2 = two * q.z;
    const P xw = x2 * q.w;
    const P yw = y2 * q.w;
    const P zw = z2 * q.w;
    const P length = squared_length(q);
    const P xx = x2 * q.x;
    const P yy = y2 * q.y;
    Matrix3<P> r;
    r.entry[0][0] = fnma(z2, q.z, length - yy);
    r.entry[0][1] = fma(x2, q.y, -zw);
    r.entry[0][2] = fma(x2, q.z, yw);
    r.entry[1][0] = fma(x2, q.y, zw);
    r.entry[1][1] = fnma(z2, q.z, length - xx);
    r.entry[1][2] = fma(y2, q.z, -xw);
    r.entry[2][0] = fma(x2, q.z, -yw);
    r.entry[2][1] = fma(y2, q.z, xw);
    r.entry[2][2] = (length - xx) - yy;
    return r;
}

}  // namespace lancet::kernels
