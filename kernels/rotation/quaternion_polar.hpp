#pragma once

#include "lancet/kernels/rotation/prescale.hpp"
#include "lancet/kernels/rotation/quaternion.hpp"

namespace lancet::kernels {

/// Where a Newton step of the analytic polar decomposition leads.
template <class P>
struct RotationStep {
    Quaternion<P> rotation;  ///< not normalised: 1 <= |q| / |start| < 2
    Mask<typename P::Isa, typename P::Real> converged;
};

/// The local problem at a rotation: with B = R^T F, tr(exp(w)^T B) = tr B + g.w - w.H w / 2 + ...
template <class P>
struct RotationDerivatives {
    P trace;
    P gradient[3];   ///< axial(B) = (B32 - B23, B13 - B31, B21 - B12)
    P symmetric[6];  ///< (B + B^T) / 2: 11, 22, 33, 23, 31, 12; the Hessian is H = tr(B) 1 - symmetric
};

template <class P>
LANCET_INLINE RotationDerivatives<P> rotation_derivatives(const Matrix3<P>& f, const Quaternion<P>& q) {
    const Matrix3<P> b = multiply_transposed(to_matrix(q), f);
    const P half(typename P::Real(0.5));
    return {b.entry[0][0] + b.entry[1][1] + b.entry[2][2],
            {b.entry[2][1] - b.entry[1][2], b.entry[0][2] - b.entry[2][0], b.entry[1][0] - b.entry[0][1]},
            {b.entry[0][0], b.entry[1][1], b.entry[2][2], half * (b.entry[2][1] + b.entry[1][2]),
             half * (b.entry[0][2] + b.entry[2][0]), half * (b.entry[1][0] + b.entry[0][1])}};
}

/// The solution of (shift 1 - S) w = g as numerators and denominator, so that nothing is divided.
template <class P>
struct ShiftedSolution {
    P numerator[3];    ///< adj(shift 1 - S) g
    P determinant;     ///< det(shift 1 - S)
    P adjugate_trace;  ///< the second invariant of shift 1 - S
};

template <class P>
LANCET_INLINE ShiftedSolution<P> solve_shifted(const RotationDerivatives<P>& d, P shift) {
    const P* s = d.symmetric;
    const P* g = d.gradient;
    const P h11 = shift - s[0];
    const P h22 = shift - s[1];
    const P h33 = shift - s[2];
    // The off-diagonal entries of the matrix are -s; their products below have the signs that follow.
    const P a11 = fnma(s[3], s[3], h22 * h33);
    const P a22 = fnma(s[4], s[4], h33 * h11);
    const P a33 = fnma(s[5], s[5], h11 * h22);
    const P a23 = fma(s[4], s[5], h11 * s[3]);
    const P a31 = fma(s[5], s[3], h22 * s[4]);
    const P a12 = fma(s[3], s[4], h33 * s[5]);
    return {{fma(a31, g[2], fma(a12, g[1], a11 * g[0])), fma(a23, g[2], fma(a22, g[1], a12 * g[0])),
             fma(a33, g[2], fma(a23, g[1], a31 * g[0]))},
            fnma(s[4], a31, fnma(s[5], a12, h11 * a11)),
            a11 + a22 + a33};
}

/// A bound of the largest eigenvalue of S from above, exact where the two smaller ones are equal, and 5 % of the size
/// of S more: shift 1 - S is then positive definite unless S = 0.
template <class P>
LANCET_INLINE P safe_shift(const RotationDerivatives<P>& d) {
    using Real = typename P::Real;
    const P* s = d.symmetric;
    const P mean = d.trace * P(Real(1.0 / 3.0));
    const P d1 = s[0] - mean;
    const P d2 = s[1] - mean;
    const P d3 = s[2] - mean;
    const P shear = fma(s[5], s[5], fma(s[4], s[4], s[3] * s[3]));
    const P deviator = fma(P(Real(2)), shear, fma(d3, d3, fma(d2, d2, d1 * d1)));
    const P size = sqrt(fma(P(Real(3)), mean * mean, deviator));
    const P bound = fma(P(Real(0.81649658)), sqrt(deviator), mean);
    return max(d.trace, fma(P(Real(0.05)), size, bound));
}

/// One Newton step for the rotation that maximises tr(R^T F), from any start. F must be prescaled.
///
/// The rotation vector w = H^-1 g has the length tan(angle) if what is left is a rotation about a principal axis of the
/// stretch; therefore the step turns by arctan |w|, which is exact there and of third order elsewhere. Where H is not
/// safely positive definite there are two ways on. The same step, with the angle continued to the second quadrant, up
/// to about 117 degrees, and with a floor under |det H|, still ascends unless g lies badly. Else a shifted Hessian
/// makes it an ascent. What F does not determine (a gap s2 +- s3 below about 64 epsilon s1) hardly moves.
///
/// A lane is converged when H is safely positive definite and the step not longer than `longest`, by default so short
/// that what it leaves is rounding; as tr(R^T F) is a quadratic form in the quaternion, every local maximum is the
/// global one.
template <class P>
LANCET_INLINE RotationStep<P> rotation_step(const Matrix3<P>& f, const Quaternion<P>& start,
                                            typename P::Real longest = RotationConstants<P>::cube_root_epsilon) {
    using Real = typename P::Real;
    using Constants = RotationConstants<P>;
    const P zero(Real(0));
    const auto d = rotation_derivatives(f, start);
    auto w = solve_shifted(d, d.trace);
    const P least = P(Real(64) * Constants::epsilon) * (d.trace * d.trace * d.trace);
    // All three invariants of H (its trace is 2 tr B) are positive.
    const auto safe = (d.trace > zero) & (w.adjugate_trace > zero) & (w.determinant > least);
    if (!all(safe)) [[unlikely]] {
        const auto ascent = solve_shifted(d, safe_shift(d));
        const P progress =
            fma(w.numerator[2], d.gradient[2], fma(w.numerator[1], d.gradient[1], w.numerator[0] * d.gradient[0]));
        const auto turning = progress > zero;
        const P floor = abs(least);
        const P numerator_length = sqrt(
            fma(w.numerator[2], w.numerator[2], fma(w.numerator[1], w.numerator[1], w.numerator[0] * w.numerator[0])));
        const P obtuse = max(w.determinant, P(Real(-0.5)) * numerator_length);
        const P determinant = select(w.determinant < -floor, obtuse, max(w.determinant, floor));
        for (int i = 0; i < 3; ++i) {
            w.numerator[i] = select(safe | turning, w.numerator[i], ascent.numerator[i]);
        }
        w.determinant = select(safe, w.determinant, select(turning, determinant, max(ascent.determinant, zero)));
    }
    const P square =
        fma(w.numerator[2], w.numerator[2], fma(w.numerator[1], w.numerator[1], w.numerator[0] * w.numerator[0]));
    const P determinant_square = w.determinant * w.determinant;
    // tan(angle / 2) = |v| / (det + sqrt(det^2 + |v|^2)) for tan(angle) = |v| / det.
    const P denominator = w.determinant + sqrt(determinant_square + square);
    const P factor = P(Real(1)) / (denominator + P(Constants::tiny));
    const Quaternion<P> turn{P(Real(1)), w.numerator[0] * factor, w.numerator[1] * factor, w.numerator[2] * factor};
    return {multiply(start, turn), safe & (square <= P(longest * longest) * determinant_square)};
}

/// A step less than doubles the length, the Hessian grows with its square and the determinant of that with its sixth
/// power: what keeps them in range after step number `step`, counted from 0.
template <class P>
LANCET_INLINE Quaternion<P> keep_in_range(const Quaternion<P>& q, int step) {
    return step % 4 == 3 ? normalise(q) : q;
}

/// The analytic polar decomposition (Kugelstadt, Koschier, Bender 2018: Fast Corotated FEM using Operator Splitting):
/// `steps` Newton steps from q, a unit quaternion. The result is a unit quaternion for every finite F; it is the
/// nearest rotation if the start was near enough. A step is one long chain of dependent operations: several batches
/// together
/// (`count`) keep the processor busy.
template <int count, class P>
LANCET_INLINE void quaternion_rotations(const Matrix3<P> (&f)[count], Quaternion<P> (&q)[count], int steps) {
    Matrix3<P> scaled[count];
    for (int i = 0; i < count; ++i) scaled[i] = prescale(f[i]);
    for (int step = 0; step < steps; ++step) {
        for (int i = 0; i < count; ++i) q[i] = keep_in_range(rotation_step(scaled[i], q[i]).rotation, step);
    }
    for (int i = 0; i < count; ++i) q[i] = normalise(q[i]);
}

/// The same for one batch.
template <class P>
LANCET_INLINE Quaternion<P> quaternion_rotation(const Matrix3<P>& f, const Quaternion<P>& start, int steps) {
    const Matrix3<P> matrices[1] = {f};
    Quaternion<P> q[1] = {start};
    quaternion_rotations(matrices, q, steps);
    return q[0];
}

}  // namespace lancet::kernels
