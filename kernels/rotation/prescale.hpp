#pragma once

#include "lancet/kernels/rotation/constants.hpp"
#include "lancet/kernels/rotation/matrix3.hpp"

namespace lancet::kernels {

/// F times a positive number per lane, so that squares and cubes neither overflow nor vanish: exactly 1 where the sum
/// of the absolute entries is between 1/64 and 64, as it is in any reasonable deformation, else one over the largest
/// entry. The rotation does not change. Zero stays zero.
template <class P>
LANCET_INLINE Matrix3<P> prescale(const Matrix3<P>& f) {
    using Real = typename P::Real;
    using Constants = RotationConstants<P>;
    const P one(Real(1));
    const P size = absolute_sum(f);
    const auto reasonable = (size >= P(Real(0x1p-6))) & (size <= P(Real(0x1p6)));
    if (all(reasonable)) return f;

    // In two factors, for the reciprocal of a denormal number is infinite and that of a large one denormal.
    const P entry = largest_entry(f);
    const P coarse = select(entry > one, P(Real(1) / Constants::huge), P(Constants::huge));
    const P fine = one / max(entry * coarse, P(Constants::tiny * Constants::tiny));
    return scale(scale(f, select(reasonable, one, coarse)), select(reasonable, one, fine));
}

}  // namespace lancet::kernels
