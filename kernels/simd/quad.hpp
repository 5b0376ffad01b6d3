#pragma once

#include <cstdint>

#include "lancet/kernels/simd/pack.hpp"

#if defined(__SSE2__)
#include <immintrin.h>
#endif
#if defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace lancet::kernels {

/// The four numbers of one node (x, y, z and a spare one), as they lie in memory: what gather and scatter move whole.
/// The general form, for one lane and for instruction sets without a register of this shape.
template <class Isa, class Real>
struct Quad {
    Real number[4];

    LANCET_INLINE static Quad load(const Real* source) { return {{source[0], source[1], source[2], source[3]}}; }
    LANCET_INLINE void store(Real* destination) const {
        for (int i = 0; i < 4; ++i) destination[i] = number[i];
    }
    /// Reads and writes three numbers and nothing behind them; the fourth is zero.
    LANCET_INLINE static Quad load_three(const Real* source) { return {{source[0], source[1], source[2], Real(0)}}; }
    LANCET_INLINE void store_three(Real* destination) const {
        for (int i = 0; i < 3; ++i) destination[i] = number[i];
    }
    LANCET_INLINE friend Quad operator+(Quad a, Quad b) {
        for (int i = 0; i < 4; ++i) a.number[i] += b.number[i];
        return a;
    }
    LANCET_INLINE friend Quad operator-(Quad a, Quad b) {
        for (int i = 0; i < 4; ++i) a.number[i] -= b.number[i];
        return a;
    }
};

/// Rounds double to float.
template <class Isa>
LANCET_INLINE Quad<Isa, float> narrow(Quad<Isa, double> a) {
    return {{static_cast<float>(a.number[0]), static_cast<float>(a.number[1]), static_cast<float>(a.number[2]),
             static_cast<float>(a.number[3])}};
}

/// The same numbers in double.
template <class Isa>
LANCET_INLINE Quad<Isa, double> widen(Quad<Isa, float> a) {
    return {{a.number[0], a.number[1], a.number[2], a.number[3]}};
}

/// Transposes `width` quads into packs: components[c] holds number c of every quad.
template <class Isa, class Real>
LANCET_INLINE void transpose(const Quad<Isa, Real> (&quads)[1], Pack<Isa, Real> (&components)[4]) {
    for (int c = 0; c < 4; ++c) components[c] = Pack<Isa, Real>(quads[0].number[c]);
}
template <class Isa, class Real>
LANCET_INLINE void transpose(const Pack<Isa, Real> (&components)[4], Quad<Isa, Real> (&quads)[1]) {
    for (int c = 0; c < 4; ++c) quads[0].number[c] = components[c].value;
}

}  // namespace lancet::kernels

#if defined(__SSE2__)
#include "lancet/kernels/simd/quad_x86.hpp"
#endif
#if defined(__aarch64__)
#include "lancet/kernels/simd/quad_neon.hpp"
#endif
