#pragma once

namespace lancet::kernels {

/// What the rotation methods know about their arithmetic.
template <class P>
struct RotationConstants {
    using Real = typename P::Real;
    static constexpr bool single = sizeof(Real) == 4;

    /// The distance from 1 to the next number.
    static constexpr Real epsilon = single ? Real(1.1920929e-7) : Real(2.220446049250313e-16);
    /// The cube root of epsilon: a Newton step of this length leaves an error of epsilon, for its order is three.
    static constexpr Real cube_root_epsilon = single ? Real(4.9215666e-3) : Real(6.055454452393343e-6);
    /// The sixth root of epsilon / 1000: as |F - R| is least at the rotation, a Newton step of this length leaves in
    /// its square the error epsilon / 1000.
    static constexpr Real sixth_root_epsilon = single ? Real(2.2184e-2) : Real(7.7817e-4);
    /// Below the square of anything that counts in a matrix of size 1, and above the root of the smallest number.
    static constexpr Real tiny = single ? Real(0x1p-60) : Real(0x1p-500);
    /// Takes every finite number, denormal ones too, into a range whose reciprocal is finite; its inverse likewise.
    static constexpr Real huge = single ? Real(0x1p64) : Real(0x1p512);
};

}  // namespace lancet::kernels
