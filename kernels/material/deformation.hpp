#pragma once

#include "lancet/kernels/rotation/matrix3.hpp"

namespace lancet::kernels {

/// What the energy of a material depends on, in every lane. A material is a class template over the pack P,
///
///     struct Material {
///         static constexpr bool uses_rotation;  // reads the rotation
///         static constexpr bool is_convex;      // its tangent has no negative eigenvalue at any F
///         Material(const Deformation<P>& at, P lambda_over_mu);
///         P energy() const;                                    // W / mu, per rest volume
///         Matrix3<P> stress() const;                           // first Piola-Kirchhoff stress dW/dF / mu
///         Matrix3<P> tangent(const Matrix3<P>& change) const;  // (d^2 W / dF^2) : change / mu, exact
///         static PrincipalDerivatives<P> principal(const P (&stretch)[3], P lambda_over_mu);  // unless is_convex
///     };
///
/// and knows neither elements nor indices.
template <class P>
struct Deformation {
    Matrix3<P> gradient;  ///< F
    Matrix3<P> rotation;  ///< the proper rotation that maximises tr(R^T F); only for materials that use it
};

/// F - 1.
template <class P>
LANCET_INLINE Matrix3<P> minus_identity(const Matrix3<P>& f) {
    Matrix3<P> g = f;
    for (int i = 0; i < 3; ++i) g.entry[i][i] -= P(typename P::Real(1));
    return g;
}

/// a : b, the sum of the products of the entries.
template <class P>
LANCET_INLINE P contract(const Matrix3<P>& a, const Matrix3<P>& b) {
    P sum(typename P::Real(0));
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) sum = fma(a.entry[i][j], b.entry[i][j], sum);
    }
    return sum;
}

}  // namespace lancet::kernels
