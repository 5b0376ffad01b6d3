#pragma once

#include "lancet/kernels/material/deformation.hpp"
#include "lancet/kernels/material/hooke.hpp"
#include "lancet/kernels/material/principal_derivatives.hpp"
#include "lancet/kernels/rotation/constants.hpp"

namespace lancet::kernels {

/// Hooke's law in the frame of the rotation R of F: W / mu = |F - R|^2 + (lambda / mu) tr(R^T F - 1)^2 / 2.
///
/// Its rotation is undefined where two stretches add up to zero, and its exact tangent grows without bound there: what
/// would be divided by is kept away from zero by rounding, so that the result stays finite.
template <class P>
class CorotationalMaterial {
  public:
    static constexpr bool uses_rotation = true;
    static constexpr bool is_convex = false;

    LANCET_INLINE CorotationalMaterial(const Deformation<P>& at, P lambda_over_mu)
        : gradient_(at.gradient), rotation_(at.rotation), lambda_(lambda_over_mu) {
        using Real = typename P::Real;
        // r : (f - r) sums to tr(R^T F) - 3, without the cancellation.
        pressure_ = lambda_ * contract(rotation_, difference());

        // The inverse of H = tr(S) 1 - S with S = R^T F, whose eigenvalues are the sums of two stretches.
        const Symmetric3<P> s = symmetric_part_of_product(rotation_, gradient_);
        const P largest_sum = max(abs(s.xx + s.yy), max(abs(s.yy + s.zz), abs(s.zz + s.xx)));
        const P mixed = max(abs(s.xy), max(abs(s.xz), abs(s.yz)));
        const P scale = P(Real(1)) / max(max(largest_sum, mixed), P(RotationConstants<P>::epsilon));
        const P hxx = scale * (s.yy + s.zz), hyy = scale * (s.zz + s.xx), hzz = scale * (s.xx + s.yy);
        const P hxy = -scale * s.xy, hxz = -scale * s.xz, hyz = -scale * s.yz;
        const P cxx = fnma(hyz, hyz, hyy * hzz), cxy = fnma(hxy, hzz, hxz * hyz), cxz = fnma(hxz, hyy, hxy * hyz);
        const P determinant = fma(hxz, cxz, fma(hxy, cxy, hxx * cxx));
        const P floor(Real(4) * RotationConstants<P>::epsilon);
        const P divisor = select(determinant < P(Real(0)), min(determinant, -floor), max(determinant, floor));
        // dP = ... + (pressure - 2) dR: the factor is taken into the inverse.
        const P factor = (pressure_ - P(Real(2))) * scale / divisor;
        turn_ = {factor * cxx, factor * fnma(hxz, hxz, hxx * hzz), factor * fnma(hxy, hxy, hxx * hyy), factor * cxy,
                 factor * cxz, factor * fnma(hxx, hyz, hxy * hxz)};
    }

    LANCET_INLINE P energy() const {
        return corotational_energy(gradient_, rotation_, P(typename P::Real(1)), lambda_);
    }
    LANCET_INLINE Matrix3<P> stress() const {
        Matrix3<P> result = difference();
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                const P twice = result.entry[i][j] + result.entry[i][j];
                result.entry[i][j] = fma(pressure_, rotation_.entry[i][j], twice);
            }
        }
        return result;
    }
    /// dP = 2 dF + lambda (R : dF) R + (lambda tr(S - 1) - 2) dR with S = R^T F and dR = R [w]x, where (tr(S) 1 - S) w
    /// is the axial vector of R^T dF.
    LANCET_INLINE Matrix3<P> tangent(const Matrix3<P>& change) const {
        const Matrix3<P> back = multiply_transposed(rotation_, change);
        const Vector3<P> axial{back.entry[2][1] - back.entry[1][2], back.entry[0][2] - back.entry[2][0],
                               back.entry[1][0] - back.entry[0][1]};
        const Vector3<P> w = multiply(turn_, axial);
        const P pressure = lambda_ * (back.entry[0][0] + back.entry[1][1] + back.entry[2][2]);
        const Matrix3<P> local{{{pressure, -w.z, w.y}, {w.z, pressure, -w.x}, {-w.y, w.x, pressure}}};
        Matrix3<P> product = multiply(rotation_, local);
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) product.entry[i][j] += change.entry[i][j] + change.entry[i][j];
        }
        return product;
    }
    /// The product with the usual approximation that holds the rotation fixed, R (Hooke : R^T dF): R K R^T.
    LANCET_INLINE Matrix3<P> rotated_tangent(const Matrix3<P>& change) const {
        return multiply(rotation_, to_matrix(hooke_stress(multiply_transposed(rotation_, change), lambda_)));
    }

    /// W = sum (s_i - 1)^2 + (lambda / 2) (sum s_i - 3)^2.
    LANCET_INLINE static PrincipalDerivatives<P> principal(const P (&stretch)[3], P lambda_over_mu) {
        using Real = typename P::Real;
        const P one(Real(1)), two(Real(2));
        const P strain[3] = {stretch[0] - one, stretch[1] - one, stretch[2] - one};
        const P pressure = lambda_over_mu * (strain[0] + strain[1] + strain[2]);
        const P size = max(max(abs(stretch[0]), abs(stretch[1])), max(abs(stretch[2]), one));
        const P floor = P(Real(4) * RotationConstants<P>::epsilon) * size;
        PrincipalDerivatives<P> derivatives;
        for (int k = 0; k < 3; ++k) {
            derivatives.first[k] = fma(two, strain[k], pressure);
            derivatives.flip[k] = two;
            const P sum = max(stretch[pair_first(k)] + stretch[pair_second(k)], floor);
            derivatives.twist[k] = fma(two, (pressure - two) / sum, two);
        }
        const P diagonal = two + lambda_over_mu;
        derivatives.second = {diagonal, diagonal, diagonal, lambda_over_mu, lambda_over_mu, lambda_over_mu};
        return derivatives;
    }

  private:
    /// F - R.
    LANCET_INLINE Matrix3<P> difference() const {
        Matrix3<P> result;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) result.entry[i][j] = gradient_.entry[i][j] - rotation_.entry[i][j];
        }
        return result;
    }

    Matrix3<P> gradient_;
    Matrix3<P> rotation_;
    P lambda_;
    P pressure_;          ///< lambda tr(R^T F - 1)
    Symmetric3<P> turn_;  ///< (pressure - 2) (tr(S) 1 - S)^-1
};

}  // namespace lancet::kernels
