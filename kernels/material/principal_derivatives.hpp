#pragma once

#include "lancet/kernels/rotation/symmetric3.hpp"

namespace lancet::kernels {

/// Derivatives of an isotropic energy density W(s1, s2, s3) by the principal stretches, divided by mu. The pair of
/// index k is that of the other two stretches, i and j (k = 0: the second and the third).
template <class P>
struct PrincipalDerivatives {
    P first[3];            ///< W_i = dW / ds_i
    Symmetric3<P> second;  ///< W_ij
    P flip[3];             ///< (W_i - W_j) / (s_i - s_j), in a form without the difference
    P twist[3];            ///< (W_i + W_j) / (s_i + s_j), in a form without cancellation
};

/// The two stretches of pair k.
constexpr int pair_first(int k) {
    return (k + 1) % 3;
}
constexpr int pair_second(int k) {
    return (k + 2) % 3;
}

}  // namespace lancet::kernels
