#pragma once

#include "lancet/kernels/material/deformation.hpp"
#include "lancet/kernels/material/principal_derivatives.hpp"

namespace lancet::kernels {

/// Hooke's law for Green's strain: W / mu = |E|^2 + (lambda / mu) tr(E)^2 / 2 with E = (F^T F - 1) / 2. Softens under
/// compression and does not resist inversion: the tangent is indefinite there.
template <class P>
class StVenantKirchhoffMaterial {
  public:
    static constexpr bool uses_rotation = false;
    static constexpr bool is_convex = false;

    LANCET_INLINE StVenantKirchhoffMaterial(const Deformation<P>& at, P lambda_over_mu)
        : gradient_(at.gradient), lambda_(lambda_over_mu) {
        // With F = 1 + G: E = (G + G^T + G^T G) / 2, which near rest does not cancel.
        const Matrix3<P> g = minus_identity(gradient_);
        const Symmetric3<P> linear = symmetric_part(g), square = symmetric_part(multiply_transposed(g, g));
        const P half(typename P::Real(0.5));
        strain_ = {fma(half, square.xx, linear.xx), fma(half, square.yy, linear.yy), fma(half, square.zz, linear.zz),
                   fma(half, square.xy, linear.xy), fma(half, square.xz, linear.xz), fma(half, square.yz, linear.yz)};
        second_stress_ = to_matrix(stress_of(strain_));
    }

    LANCET_INLINE P energy() const {
        const Symmetric3<P>& e = strain_;
        const P two(typename P::Real(2)), half(typename P::Real(0.5));
        const P mixed = fma(e.yz, e.yz, fma(e.xz, e.xz, e.xy * e.xy));
        const P square = fma(two, mixed, fma(e.zz, e.zz, fma(e.yy, e.yy, e.xx * e.xx)));
        const P trace = e.xx + e.yy + e.zz;
        return fma(half * lambda_, trace * trace, square);
    }
    LANCET_INLINE Matrix3<P> stress() const { return multiply(gradient_, second_stress_); }
    /// The stress at the middle F of a step from F - H to F + H, with the mean of the strains at both ends: its power
    /// in the step is the change of the energy (Simo and Tarnow 1992). The mean strain is E(F) + H^T H / 2.
    LANCET_INLINE Matrix3<P> average_stress(const Matrix3<P>& half_change) const {
        const Symmetric3<P> square = symmetric_part(multiply_transposed(half_change, half_change));
        const P half(typename P::Real(0.5));
        const Symmetric3<P> mean{fma(half, square.xx, strain_.xx), fma(half, square.yy, strain_.yy),
                                 fma(half, square.zz, strain_.zz), fma(half, square.xy, strain_.xy),
                                 fma(half, square.xz, strain_.xz), fma(half, square.yz, strain_.yz)};
        return multiply(gradient_, to_matrix(stress_of(mean)));
    }
    LANCET_INLINE Matrix3<P> tangent(const Matrix3<P>& change) const {
        const Matrix3<P> geometric = multiply(change, second_stress_);
        Matrix3<P> product = multiply(gradient_, to_matrix(stress_of(symmetric_part_of_product(gradient_, change))));
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) product.entry[i][j] += geometric.entry[i][j];
        }
        return product;
    }

    /// With e_i = (s_i^2 - 1) / 2: W = sum e_i^2 + (lambda / 2) (sum e_i)^2.
    LANCET_INLINE static PrincipalDerivatives<P> principal(const P (&stretch)[3], P lambda_over_mu) {
        using Real = typename P::Real;
        const P one(Real(1)), half(Real(0.5)), three(Real(3));
        P square[3], trace(Real(0));
        for (int i = 0; i < 3; ++i) {
            square[i] = stretch[i] * stretch[i];
            trace += half * fma(stretch[i], stretch[i], -one);
        }
        const P common = fma(lambda_over_mu, trace, -one);
        PrincipalDerivatives<P> derivatives;
        P diagonal[3], mixed[3];
        for (int k = 0; k < 3; ++k) {
            const int i = pair_first(k), j = pair_second(k);
            derivatives.first[k] = stretch[k] * (square[k] + common);
            const P product = stretch[i] * stretch[j], sum = square[i] + square[j] + common;
            derivatives.flip[k] = sum + product;
            derivatives.twist[k] = sum - product;
            diagonal[k] = fma(three + lambda_over_mu, square[k], common);
            mixed[k] = lambda_over_mu * product;
        }
        derivatives.second = {diagonal[0], diagonal[1], diagonal[2], mixed[2], mixed[1], mixed[0]};
        return derivatives;
    }

  private:
    /// The second Piola-Kirchhoff stress of a strain.
    LANCET_INLINE Symmetric3<P> stress_of(const Symmetric3<P>& e) const {
        const P two(typename P::Real(2));
        const P pressure = lambda_ * (e.xx + e.yy + e.zz);
        return {fma(two, e.xx, pressure),
                fma(two, e.yy, pressure),
                fma(two, e.zz, pressure),
                two * e.xy,
                two * e.xz,
                two * e.yz};
    }

    Matrix3<P> gradient_;
    P lambda_;
    Symmetric3<P> strain_;
    Matrix3<P> second_stress_;
};

}  // namespace lancet::kernels
