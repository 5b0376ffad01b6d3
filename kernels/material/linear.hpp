#pragma once

#include "lancet/kernels/material/deformation.hpp"
#include "lancet/kernels/material/hooke.hpp"

namespace lancet::kernels {

/// Hooke's law for small strains: W / mu = |e|^2 + (lambda / mu) tr(e)^2 / 2 with e the symmetric part of F - 1. Not
/// objective: a finite rotation counts as a strain.
template <class P>
class LinearMaterial {
  public:
    static constexpr bool uses_rotation = false;
    static constexpr bool is_convex = true;

    LANCET_INLINE LinearMaterial(const Deformation<P>& at, P lambda_over_mu)
        : displacement_gradient_(minus_identity(at.gradient)), lambda_(lambda_over_mu) {}

    LANCET_INLINE P energy() const {
        return hooke_energy(displacement_gradient_, hooke_stress(displacement_gradient_, lambda_));
    }
    LANCET_INLINE Matrix3<P> stress() const { return to_matrix(hooke_stress(displacement_gradient_, lambda_)); }
    LANCET_INLINE Matrix3<P> tangent(const Matrix3<P>& change) const {
        return to_matrix(hooke_stress(change, lambda_));
    }

  private:
    Matrix3<P> displacement_gradient_;
    P lambda_;
};

}  // namespace lancet::kernels
