#pragma once

#include "lancet/kernels/rotation/quaternion_polar.hpp"

namespace lancet::kernels {

/// Cosine and sine of half an angle.
template <class P>
struct HalfAngle {
    P cosine, sine;
};

/// The turn about axis `r` that makes entry (p, q) of a symmetric matrix vanish, or at least smaller, where p, q, r are
/// cyclic: the approximate Givens angle of McAdams et al., without trigonometric functions.
template <class P>
LANCET_INLINE HalfAngle<P> jacobi_angle(P s_pp, P s_qq, P s_pq) {
    using Real = typename P::Real;
    const P one(Real(1));
    const P cosine = P(Real(2)) * (s_pp - s_qq);
    const P cosine2 = cosine * cosine;
    const P sine2 = s_pq * s_pq;
    const auto nothing = sine2 <= P(RotationConstants<P>::tiny * RotationConstants<P>::tiny);
    const auto small = P(Real(5.8284271247461903)) * sine2 < cosine2;  // 3 + sqrt(8) = tan(pi/8)^-2
    const P factor = one / sqrt(select(small, cosine2 + sine2, one));
    const P c = select(small, cosine * factor, P(Real(0.92387953251128674)));
    const P s = select(small, s_pq * factor, P(Real(0.38268343236508977)));
    return {select(nothing, one, c), select(nothing, P(Real(0)), s)};
}

/// S <- Q^T S Q for the turn Q about axis r; s holds the diagonal pp, qq and the entries pq, pr, qr.
template <class P>
LANCET_INLINE void jacobi_turn(P& s_pp, P& s_qq, P& s_pq, P& s_pr, P& s_qr, P& q_w, P& q_p, P& q_q, P& q_r) {
    const P two(typename P::Real(2));
    const auto half = jacobi_angle(s_pp, s_qq, s_pq);
    const P c = fnma(half.sine, half.sine, half.cosine * half.cosine);
    const P s = two * half.cosine * half.sine;
    const P cc = c * c;
    const P ss = s * s;
    const P cs = c * s;
    const P cross = two * cs * s_pq;
    const P pp = fma(ss, s_qq, fma(cc, s_pp, cross));
    const P qq = fma(cc, s_qq, fma(ss, s_pp, -cross));
    const P pq = fnma(cs, s_pp - s_qq, (cc - ss) * s_pq);
    const P pr = fma(s, s_qr, c * s_pr);
    const P qr = fnma(s, s_pr, c * s_qr);
    s_pp = pp;
    s_qq = qq;
    s_pq = pq;
    s_pr = pr;
    s_qr = qr;
    // q <- q (cosine + sine e_r)
    const P w = fnma(q_r, half.sine, q_w * half.cosine);
    const P x = fma(q_q, half.sine, q_p * half.cosine);
    const P y = fnma(q_p, half.sine, q_q * half.cosine);
    const P z = fma(q_w, half.sine, q_r * half.cosine);
    q_w = w;
    q_p = x;
    q_q = y;
    q_r = z;
}

/// The turn that takes the plane vector (x, y) onto the positive first axis; none where the vector is nothing.
template <class P>
LANCET_INLINE HalfAngle<P> givens_angle(P x, P y) {
    using Real = typename P::Real;
    const P zero(Real(0));
    const P one(Real(1));
    const P tiny(RotationConstants<P>::tiny);
    const auto nothing = (abs(x) <= tiny) & (abs(y) <= tiny);
    const P a = select(nothing, one, x);
    const P b = select(nothing, zero, y);
    const P h = abs(a) + sqrt(fma(b, b, a * a));
    const auto right = a >= zero;
    const P cosine = select(right, h, b);
    const P sine = select(right, b, h);
    const P factor = one / sqrt(fma(sine, sine, cosine * cosine));
    return {cosine * factor, sine * factor};
}

/// Swaps columns p and q of B = F V, changing one sign so that V stays proper, where column q is the longer one.
template <class P>
LANCET_INLINE void sort_columns(Matrix3<P>& b, P& length_p, P& length_q, int p, int q, P& v_w, P& v_p, P& v_q, P& v_r) {
    using Real = typename P::Real;
    const auto swapped = length_p < length_q;
    for (int row = 0; row < 3; ++row) {
        const P x = b.entry[row][p];
        const P y = b.entry[row][q];
        b.entry[row][p] = select(swapped, y, x);
        b.entry[row][q] = select(swapped, -x, y);
    }
    const P longer = select(swapped, length_q, length_p);
    length_q = select(swapped, length_p, length_q);
    length_p = longer;
    // v <- v (c + s e_r), a quarter turn
    const P root_half(Real(0.70710678118654752));
    const P c = select(swapped, root_half, P(Real(1)));
    const P s = select(swapped, root_half, P(Real(0)));
    const P w = fnma(v_r, s, v_w * c);
    const P x = fma(v_q, s, v_p * c);
    const P y = fnma(v_p, s, v_q * c);
    const P z = fma(v_w, s, v_r * c);
    v_w = w;
    v_p = x;
    v_q = y;
    v_r = z;
}

/// The rotation U V^T of the singular value decomposition F = U S V^T with proper U and V: the smallest singular value
/// takes the sign of det F (inversion convention). Needs no start and holds for every finite F.
///
/// McAdams et al. 2011 (Computing the Singular Value Decomposition of 3 x 3 matrices with minimal branching and
/// elementary floating point operations): Jacobi turns diagonalise F^T F, accumulated as a quaternion V; the columns of
/// F V are sorted by length; Givens turns triangularise them, accumulated as U. F^T F has lost half the digits of the
/// small singular values: two Newton steps on the product give them back.
template <class P>
LANCET_INLINE Quaternion<P> svd_rotation(const Matrix3<P>& f) {
    const Matrix3<P> scaled = prescale(f);
    const Matrix3<P> s = multiply_transposed(scaled, scaled);
    P s00 = s.entry[0][0];
    P s11 = s.entry[1][1];
    P s22 = s.entry[2][2];
    P s01 = s.entry[0][1];
    P s12 = s.entry[1][2];
    P s20 = s.entry[2][0];
    Quaternion<P> v = identity_quaternion<P>();
    constexpr int sweeps = RotationConstants<P>::single ? 4 : 5;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        jacobi_turn(s00, s11, s01, s20, s12, v.w, v.x, v.y, v.z);
        jacobi_turn(s11, s22, s12, s01, s20, v.w, v.y, v.z, v.x);
        jacobi_turn(s22, s00, s20, s12, s01, v.w, v.z, v.x, v.y);
    }
    v = normalise(v);

    Matrix3<P> b = multiply(scaled, to_matrix(v));
    P length[3];
    for (int i = 0; i < 3; ++i) {
        length[i] = fma(b.entry[2][i], b.entry[2][i], fma(b.entry[1][i], b.entry[1][i], b.entry[0][i] * b.entry[0][i]));
    }
    sort_columns(b, length[0], length[1], 0, 1, v.w, v.x, v.y, v.z);
    sort_columns(b, length[1], length[2], 1, 2, v.w, v.y, v.z, v.x);
    sort_columns(b, length[0], length[1], 0, 1, v.w, v.x, v.y, v.z);

    // Each turn acts on two rows; of the first column nothing is needed after the second turn.
    const auto z = givens_angle(b.entry[0][0], b.entry[1][0]);
    const P two(typename P::Real(2));
    const P cz = fnma(z.sine, z.sine, z.cosine * z.cosine);
    const P sz = two * z.cosine * z.sine;
    const P b00 = fma(sz, b.entry[1][0], cz * b.entry[0][0]);
    const P b01 = fma(sz, b.entry[1][1], cz * b.entry[0][1]);
    const P b11 = fnma(sz, b.entry[0][1], cz * b.entry[1][1]);

    const auto y = givens_angle(b00, b.entry[2][0]);
    const P cy = fnma(y.sine, y.sine, y.cosine * y.cosine);
    const P sy = two * y.cosine * y.sine;
    const P b21 = fnma(sy, b01, cy * b.entry[2][1]);

    const auto x = givens_angle(b11, b21);
    const P zero(typename P::Real(0));
    const Quaternion<P> u =
        multiply(multiply(Quaternion<P>{z.cosine, zero, zero, z.sine}, {y.cosine, zero, -y.sine, zero}),
                 {x.cosine, x.sine, zero, zero});

    Quaternion<P> q = normalise(multiply(u, conjugate(v)));
    for (int step = 0; step < 2; ++step) q = rotation_step(scaled, q).rotation;
    return normalise(q);
}

/// svd_rotation as a function of its own: it is rarely called where it stands.
template <class P>
[[gnu::noinline, gnu::cold]] Quaternion<P> distant_svd_rotation(const Matrix3<P>& f) {
    return svd_rotation(f);
}

}  // namespace lancet::kernels
