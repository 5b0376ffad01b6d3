#pragma once

#include "lancet/kernels/rotation/symmetric3.hpp"

namespace lancet::kernels {

/// Hooke's law for an isotropic material, divided by mu: G + G^T + (lambda / mu) tr(G) 1, for a displacement gradient
/// G.
template <class P>
LANCET_INLINE Symmetric3<P> hooke_stress(const Matrix3<P>& g, P lambda_over_mu) {
    const P pressure = lambda_over_mu * (g.entry[0][0] + g.entry[1][1] + g.entry[2][2]);
    return {fma(P(2), g.entry[0][0], pressure), fma(P(2), g.entry[1][1], pressure), fma(P(2), g.entry[2][2], pressure),
            g.entry[0][1] + g.entry[1][0],      g.entry[0][2] + g.entry[2][0],      g.entry[1][2] + g.entry[2][1]};
}

/// The energy density stress : G / 2, divided by mu.
template <class P>
LANCET_INLINE P hooke_energy(const Matrix3<P>& g, const Symmetric3<P>& s) {
    P energy = s.xx * g.entry[0][0];
    energy = fma(s.yy, g.entry[1][1], energy);
    energy = fma(s.zz, g.entry[2][2], energy);
    energy = fma(s.xy, g.entry[0][1] + g.entry[1][0], energy);
    energy = fma(s.xz, g.entry[0][2] + g.entry[2][0], energy);
    energy = fma(s.yz, g.entry[1][2] + g.entry[2][1], energy);
    return P(typename P::Real(0.5)) * energy;
}

/// The same energy density for G = F R^T - 1 without the product: |G| = |F - R|, and where R is the rotation of F,
/// F R^T is symmetric: |F - R|^2 + (lambda / mu) tr(R^T F - 1)^2 / 2. `root` is a common factor of F and of the
/// result's root.
template <class P>
LANCET_INLINE P corotational_energy(const Matrix3<P>& f, const Matrix3<P>& r, P root, P lambda_over_mu) {
    P square(typename P::Real(0)), trace(typename P::Real(0));
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            // r . (f - r) sums to tr(R^T F) - 3, without the cancellation.
            const P difference = root * (f.entry[i][j] - r.entry[i][j]);
            square = fma(difference, difference, square);
            trace = fma(r.entry[i][j], difference, trace);
        }
    }
    return fma(P(typename P::Real(0.5)) * lambda_over_mu, trace * trace, square);
}

}  // namespace lancet::kernels
