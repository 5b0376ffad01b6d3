#pragma once

#include "lancet/kernels/material/deformation.hpp"
#include "lancet/kernels/material/principal_derivatives.hpp"
#include "lancet/kernels/rotation/principal_stretches.hpp"

namespace lancet::kernels {

/// The nearest positive semidefinite matrix in Frobenius' norm: negative eigenvalues become zero. A positive definite
/// matrix is returned as it is.
template <class P>
LANCET_INLINE Symmetric3<P> positive_part(const Symmetric3<P>& a) {
    const P zero(typename P::Real(0));
    const P minor = fnma(a.xy, a.xy, a.xx * a.yy);
    const P cxy = fnma(a.xy, a.zz, a.xz * a.yz), cxz = fnma(a.xz, a.yy, a.xy * a.yz);
    const P determinant = fma(a.xz, cxz, fma(a.xy, cxy, a.xx * fnma(a.yz, a.yz, a.yy * a.zz)));
    const auto positive = (a.xx > zero) & (minor > zero) & (determinant > zero);
    if (all(positive)) return a;

    const SymmetricEigen<P> eigen = symmetric_eigen(a);
    Symmetric3<P> clamped = a;
    for (int k = 0; k < 3; ++k) {
        const P x = eigen.vectors.entry[0][k], y = eigen.vectors.entry[1][k], z = eigen.vectors.entry[2][k];
        const P lift = max(-eigen.value[k], zero);
        clamped = {fma(lift * x, x, clamped.xx), fma(lift * y, y, clamped.yy), fma(lift * z, z, clamped.zz),
                   fma(lift * x, y, clamped.xy), fma(lift * x, z, clamped.xz), fma(lift * y, z, clamped.yz)};
    }
    return select(positive, a, clamped);
}

/// The tangent of an isotropic material with its negative eigenvalues set to zero, from the analytic eigensystem in the
/// frame of the principal stretches F = U diag(s) V^T (Smith, de Goes, Kim 2019: Analytic eigensystems for isotropic
/// distortion energies). For M = U^T dF V: the diagonal of M sees the matrix W_ij, the symmetric part of a pair of
/// entries its flip eigenvalue, the antisymmetric part its twist eigenvalue.
template <class P>
class ProjectedTangent {
  public:
    LANCET_INLINE ProjectedTangent(const PrincipalStretches<P>& stretches, const PrincipalDerivatives<P>& derivatives)
        : left_(stretches.left), right_(stretches.right), scaling_(positive_part(derivatives.second)) {
        const P zero(typename P::Real(0)), half(typename P::Real(0.5));
        for (int k = 0; k < 3; ++k) {
            const P flip = max(derivatives.flip[k], zero), twist = max(derivatives.twist[k], zero);
            same_[k] = half * (flip + twist);
            other_[k] = half * (flip - twist);
        }
    }

    /// The projected second derivative times a change of F.
    LANCET_INLINE Matrix3<P> tangent(const Matrix3<P>& change) const {
        const Matrix3<P> m = multiply(multiply_transposed(left_, change), right_);
        const Vector3<P> diagonal = multiply(scaling_, Vector3<P>{m.entry[0][0], m.entry[1][1], m.entry[2][2]});
        Matrix3<P> n;
        n.entry[0][0] = diagonal.x;
        n.entry[1][1] = diagonal.y;
        n.entry[2][2] = diagonal.z;
        for (int k = 0; k < 3; ++k) {
            const int i = pair_first(k), j = pair_second(k);
            n.entry[i][j] = fma(other_[k], m.entry[j][i], same_[k] * m.entry[i][j]);
            n.entry[j][i] = fma(other_[k], m.entry[i][j], same_[k] * m.entry[j][i]);
        }
        // U N V^T
        Matrix3<P> half_way = multiply(left_, n), product;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                product.entry[i][j] =
                    fma(half_way.entry[i][2], right_.entry[j][2],
                        fma(half_way.entry[i][1], right_.entry[j][1], half_way.entry[i][0] * right_.entry[j][0]));
            }
        }
        return product;
    }

  private:
    Matrix3<P> left_;
    Matrix3<P> right_;
    Symmetric3<P> scaling_;
    P same_[3];   ///< (flip + twist) / 2: on the entry itself
    P other_[3];  ///< (flip - twist) / 2: on the transposed entry
};

/// The projected tangent of a material at a deformation whose rotation is known.
template <template <class> class Material, class P>
LANCET_INLINE ProjectedTangent<P> projected_tangent(const Deformation<P>& at, P lambda_over_mu) {
    const PrincipalStretches<P> stretches = principal_stretches(at.gradient, at.rotation);
    return {stretches, Material<P>::principal(stretches.stretch, lambda_over_mu)};
}

}  // namespace lancet::kernels
