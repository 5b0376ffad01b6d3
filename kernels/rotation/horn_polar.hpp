#pragma once

#include "lancet/kernels/rotation/svd.hpp"

namespace lancet::kernels {

/// The largest eigenvalue of Horn's matrix of F, s1 + s2 +- s3 for the singular values of F, from above and to a
/// relative accuracy of about the cube root of epsilon: Laguerre's iteration on the characteristic polynomial
/// x^4 - 2 |F|^2 x^2 - 8 det F x + (|F|^4 - 4 |cof F|^2), whose roots are all real, so that it falls monotonically.
template <class P>
LANCET_INLINE P horn_eigenvalue(const Matrix3<P>& f) {
    using Real = typename P::Real;
    using Constants = RotationConstants<P>;
    const P zero(Real(0));
    const auto& a = f.entry;
    P square = a[0][0] * a[0][0];
    P cofactor_square = zero;
    P determinant = zero;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            if (i + j > 0) square = fma(a[i][j], a[i][j], square);
            const int i1 = (i + 1) % 3;
            const int i2 = (i + 2) % 3;
            const int j1 = (j + 1) % 3;
            const int j2 = (j + 2) % 3;
            const P cofactor = fnma(a[i1][j2], a[i2][j1], a[i1][j1] * a[i2][j2]);
            cofactor_square = fma(cofactor, cofactor, cofactor_square);
            if (i == 0) determinant = fma(a[0][j], cofactor, determinant);
        }
    }
    const P c2 = P(Real(-2)) * square;
    const P c1 = P(Real(-8)) * determinant;
    const P c0 = fnma(P(Real(4)), cofactor_square, square * square);

    // The square of the sum of the singular values is |F|^2 + 2 (s1 s2 + s2 s3 + s3 s1), the last at most sqrt(3) |cof
    // F|.
    P x = sqrt(fma(P(Real(2)), sqrt(P(Real(3)) * cofactor_square), square));
    constexpr int iterations = Constants::single ? 5 : 8;
    for (int iteration = 0; iteration < iterations; ++iteration) {
        const P xx = x * x;
        const P value = max(fma(fma(xx + c2, x, c1), x, c0), zero);
        const P slope = max(fma(fma(P(Real(4)), xx, P(Real(2)) * c2), x, c1), zero);
        const P curvature = fma(P(Real(12)), xx, P(Real(2)) * c2);
        const P root = sqrt(max(fnma(P(Real(12)) * value, curvature, P(Real(9)) * slope * slope), zero));
        // The floor is for multiple roots, where value and slope are rounding.
        const P denominator = max(slope + root, P(Real(4) * Constants::cube_root_epsilon) * xx * x);
        x = fnma(P(Real(4)) * value, P(Real(1)) / (denominator + P(Constants::tiny)), x);
    }
    return x;
}

/// The column of the adjugate of a symmetric 4 x 4 matrix that belongs to its largest diagonal entry.
template <class P>
LANCET_INLINE Quaternion<P> dominant_adjugate_column(P m00, P m01, P m02, P m03, P m11, P m12, P m13, P m22, P m23,
                                                     P m33) {
    // The 2 x 2 minors of rows 0, 1 (a) and of rows 2, 3 (b), by their columns.
    const P a01 = fnma(m01, m01, m00 * m11);
    const P a02 = fnma(m02, m01, m00 * m12);
    const P a03 = fnma(m03, m01, m00 * m13);
    const P a12 = fnma(m02, m11, m01 * m12);
    const P a13 = fnma(m03, m11, m01 * m13);
    const P a23 = fnma(m03, m12, m02 * m13);
    const P b02 = fnma(m22, m03, m02 * m23);
    const P b03 = fnma(m23, m03, m02 * m33);
    const P b12 = fnma(m22, m13, m12 * m23);
    const P b13 = fnma(m23, m13, m12 * m33);
    const P b23 = fnma(m23, m23, m22 * m33);

    const P c00 = fma(m13, b12, fnma(m12, b13, m11 * b23));
    const P c01 = fnma(m03, b12, fnma(m01, b23, m02 * b13));
    const P c02 = fma(m33, a12, fnma(m23, a13, m13 * a23));
    const P c03 = fnma(m23, a12, fnma(m12, a23, m22 * a13));
    const P c11 = fma(m03, b02, fnma(m02, b03, m00 * b23));
    const P c12 = fnma(m33, a02, fnma(m03, a23, m23 * a03));
    const P c13 = fma(m23, a02, fnma(m22, a03, m02 * a23));
    const P c22 = fma(m33, a01, fnma(m13, a03, m03 * a13));
    const P c23 = fnma(m23, a01, fnma(m02, a13, m12 * a03));
    const P c33 = fma(m22, a01, fnma(m12, a02, m02 * a12));

    Quaternion<P> column{c00, c01, c02, c03};
    P largest = c00;
    column = select(c11 > largest, Quaternion<P>{c01, c11, c12, c13}, column);
    largest = max(c11, largest);
    column = select(c22 > largest, Quaternion<P>{c02, c12, c22, c23}, column);
    largest = max(c22, largest);
    return select(c33 > largest, Quaternion<P>{c03, c13, c23, c33}, column);
}

/// The rotation that maximises tr(R^T F) = q^T K q, K Horn's symmetric 4 x 4 matrix of F (Horn 1987: Closed-form
/// solution of absolute orientation using unit quaternions; Higham and Noferini 2016: An algorithm to compute the polar
/// decomposition of a 3 x 3 matrix): the eigenvector of the largest eigenvalue x of K, as the largest column of
/// adj(x 1 - K), then Newton steps. x is kept a little too large, so that at a multiple eigenvalue the adjugate is
/// still well above rounding. Needs no start and holds for every finite F: lanes in which the Newton steps have not
/// converged (F of rank one, or inverted with s2 and s3 nearly equal: two or three eigenvalues of K meet) take
/// svd_rotation.
template <class P>
LANCET_INLINE Quaternion<P> polar_rotation(const Matrix3<P>& f) {
    using Real = typename P::Real;
    using Constants = RotationConstants<P>;
    const Matrix3<P> scaled = prescale(f);
    const auto& a = scaled.entry;
    const P x = horn_eigenvalue(scaled) * P(Real(1) + Constants::cube_root_epsilon);
    const Quaternion<P> column = dominant_adjugate_column(
        x - (a[0][0] + a[1][1] + a[2][2]), a[1][2] - a[2][1], a[2][0] - a[0][2], a[0][1] - a[1][0],
        x - (a[0][0] - a[1][1] - a[2][2]), -(a[0][1] + a[1][0]), -(a[0][2] + a[2][0]),
        x - (a[1][1] - a[0][0] - a[2][2]), -(a[1][2] + a[2][1]), x - (a[2][2] - a[0][0] - a[1][1]));
    // Only F = 0 has no column.
    const P size = max(max(abs(column.w), abs(column.x)), max(abs(column.y), abs(column.z)));
    const auto nothing = size <= P(Constants::tiny);
    const P factor = P(Real(1)) / select(nothing, P(Real(1)), size);
    Quaternion<P> q = select(nothing, identity_quaternion<P>(),
                             {column.w * factor, column.x * factor, column.y * factor, column.z * factor});
    q = normalise(q);
    q = normalise(rotation_step(scaled, q).rotation);
    RotationStep<P> last = rotation_step(scaled, q);
    // Where the second singular value is small or F inverts, the eigenvector was not so good.
    for (int further = 0; further < 2 && !all(last.converged); ++further) {
        const auto next = rotation_step(scaled, normalise(last.rotation));
        last.rotation = select(last.converged, last.rotation, next.rotation);
        last.converged = last.converged | next.converged;
    }
    const Quaternion<P> rotation = normalise(last.rotation);
    if (all(last.converged)) [[likely]]
        return rotation;
    return select(last.converged, rotation, distant_svd_rotation(f));
}

}  // namespace lancet::kernels
