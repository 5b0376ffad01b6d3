#pragma once

// The only door to xsimd. What version 8.1 lacks or gets wrong is mended here: fused multiply-add on AVX-512, exact
// ordered sums, scalar operands.

#include <xsimd/xsimd.hpp>

#include "lancet/kernels/simd/instruction_set.hpp"

namespace lancet::kernels {

#define LANCET_INLINE [[gnu::always_inline]] inline

namespace detail {

template <class Isa, class Real>
struct Register;

template <class Real>
struct Register<isa::scalar, Real> {
    using Batch = Real;
    using Bool = bool;
    static constexpr int width = 1;
};

template <class Architecture, class Real>
struct XsimdRegister {
    using Batch = xsimd::batch<Real, Architecture>;
    using Bool = xsimd::batch_bool<Real, Architecture>;
    static constexpr int width = static_cast<int>(Batch::size);
};

#if defined(__SSE2__)
template <class Real>
struct Register<isa::sse2, Real> : XsimdRegister<xsimd::sse2, Real> {};
#endif
#if defined(__AVX2__) && defined(__FMA__)
template <class Real>
struct Register<isa::avx2, Real> : XsimdRegister<xsimd::fma3<xsimd::avx2>, Real> {};
#endif
#if defined(__AVX512F__)
template <class Real>
struct Register<isa::avx512, Real> : XsimdRegister<xsimd::avx512dq, Real> {};
#endif
#if defined(__aarch64__)
template <class Real>
struct Register<isa::neon, Real> : XsimdRegister<xsimd::neon64, Real> {};
#endif

}  // namespace detail

/// One truth value per lane.
template <class Isa, class Real>
struct Mask {
    using Bool = typename detail::Register<Isa, Real>::Bool;
    Bool value;

    LANCET_INLINE friend Mask operator&(Mask a, Mask b) { return {static_cast<Bool>(a.value & b.value)}; }
    LANCET_INLINE friend Mask operator|(Mask a, Mask b) { return {static_cast<Bool>(a.value | b.value)}; }
    LANCET_INLINE friend Mask operator!(Mask a) { return {!a.value}; }
};

/// `width` real numbers in one register, one per lane. Arithmetic acts lane by lane and rounds like the scalar type.
template <class InstructionSet, class Scalar>
struct Pack {
    using Isa = InstructionSet;
    using Real = Scalar;
    using Batch = typename detail::Register<Isa, Real>::Batch;
    static constexpr int width = detail::Register<Isa, Real>::width;
    static constexpr bool one_lane = width == 1;

    Batch value;

    Pack() = default;
    LANCET_INLINE Pack(Batch batch) : value(batch) {}
    LANCET_INLINE Pack(Real number) requires(!one_lane) : value(number) {}

    LANCET_INLINE static Pack load(const Real* source) {
        if constexpr (one_lane) {
            return {*source};
        } else {
            return {Batch::load_unaligned(source)};
        }
    }

    LANCET_INLINE void store(Real* destination) const {
        if constexpr (one_lane) {
            *destination = value;
        } else {
            value.store_unaligned(destination);
        }
    }

    LANCET_INLINE Pack& operator+=(Pack other) { return *this = *this + other; }
    LANCET_INLINE Pack& operator-=(Pack other) { return *this = *this - other; }
    LANCET_INLINE Pack& operator*=(Pack other) { return *this = *this * other; }

    LANCET_INLINE friend Pack operator+(Pack a, Pack b) { return {a.value + b.value}; }
    LANCET_INLINE friend Pack operator-(Pack a, Pack b) { return {a.value - b.value}; }
    LANCET_INLINE friend Pack operator*(Pack a, Pack b) { return {a.value * b.value}; }
    /// The correctly rounded quotient (xsimd refines an estimate on NEON).
    LANCET_INLINE friend Pack operator/(Pack a, Pack b) {
#if defined(__aarch64__)
        if constexpr (!one_lane && sizeof(Real) == 4) return {Batch(vdivq_f32(a.value, b.value))};
#endif
        return {a.value / b.value};
    }
    LANCET_INLINE friend Pack operator-(Pack a) {
        return {-a.value};
    }

    LANCET_INLINE friend Mask<Isa, Real> operator<(Pack a, Pack b) {
        return {a.value < b.value};
    }
    LANCET_INLINE friend Mask<Isa, Real> operator<=(Pack a, Pack b) {
        return {a.value <= b.value};
    }
    LANCET_INLINE friend Mask<Isa, Real> operator>(Pack a, Pack b) {
        return {a.value > b.value};
    }
    LANCET_INLINE friend Mask<Isa, Real> operator>=(Pack a, Pack b) {
        return {a.value >= b.value};
    }
    LANCET_INLINE friend Mask<Isa, Real> operator==(Pack a, Pack b) {
        return {a.value == b.value};
    }

    /// a b + c, rounded once where the instruction set can, twice where it cannot.
    LANCET_INLINE friend Pack fma(Pack a, Pack b, Pack c) {
        if constexpr (one_lane) {
            return {a.value * b.value + c.value};
#if defined(__AVX512F__)
        } else if constexpr (width * sizeof(Real) == 64) {
            if constexpr (sizeof(Real) == 4) {
                return {Batch(_mm512_fmadd_ps(a.value, b.value, c.value))};
            } else {
                return {Batch(_mm512_fmadd_pd(a.value, b.value, c.value))};
            }
#endif
        } else {
            return {xsimd::fma(a.value, b.value, c.value)};
        }
    }

    /// c - a b, rounded as fma is.
    LANCET_INLINE friend Pack fnma(Pack a, Pack b, Pack c) {
#if defined(__aarch64__)
        if constexpr (!one_lane && sizeof(Real) == 4) return {Batch(vfmsq_f32(c.value, a.value, b.value))};
        if constexpr (!one_lane && sizeof(Real) == 8) return {Batch(vfmsq_f64(c.value, a.value, b.value))};
#endif
        if constexpr (one_lane) {
            return {c.value - a.value * b.value};
#if defined(__AVX512F__)
        } else if constexpr (width * sizeof(Real) == 64) {
            if constexpr (sizeof(Real) == 4) {
                return {Batch(_mm512_fnmadd_ps(a.value, b.value, c.value))};
            } else {
                return {Batch(_mm512_fnmadd_pd(a.value, b.value, c.value))};
            }
#endif
        } else {
            return {xsimd::fnma(a.value, b.value, c.value)};
        }
    }

    /// The smaller; b where a or b is not a number.
    LANCET_INLINE friend Pack min(Pack a, Pack b) {
        return select(a < b, a, b);
    }
    /// The larger; b where a or b is not a number.
    LANCET_INLINE friend Pack max(Pack a, Pack b) {
        return select(a > b, a, b);
    }

    LANCET_INLINE friend Pack abs(Pack a) {
        if constexpr (one_lane) {
            return {a.value < 0 ? -a.value : Real(0) + a.value};
        } else {
            return {xsimd::abs(a.value)};
        }
    }

    /// The correctly rounded square root.
    LANCET_INLINE friend Pack sqrt(Pack a) {
#if defined(__aarch64__)
        if constexpr (!one_lane && sizeof(Real) == 4) return {Batch(vsqrtq_f32(a.value))};
#endif
        if constexpr (one_lane) {
            if constexpr (sizeof(Real) == 4) {
                return {__builtin_sqrtf(a.value)};
            } else {
                return {__builtin_sqrt(a.value)};
            }
        } else {
            return {xsimd::sqrt(a.value)};
        }
    }

    /// a where the mask is true, b elsewhere.
    LANCET_INLINE friend Pack select(Mask<Isa, Real> mask, Pack a, Pack b) {
        if constexpr (one_lane) {
            return {mask.value ? a.value : b.value};
        } else {
            return {xsimd::select(mask.value, a.value, b.value)};
        }
    }

    /// True in the lanes that hold neither infinity nor not-a-number.
    LANCET_INLINE friend Mask<Isa, Real> is_finite(Pack a) {
        return a - a == Pack(Real(0));
    }

    /// The sum over the lanes, added pairwise in a fixed order.
    LANCET_INLINE friend Real sum(Pack a) {
        Real lanes[width];
        a.store(lanes);
        for (int half = width / 2; half > 0; half /= 2) {
            for (int lane = 0; lane < half; ++lane) lanes[lane] += lanes[lane + half];
        }
        return lanes[0];
    }

    /// The largest lane.
    LANCET_INLINE friend Real largest(Pack a) {
        Real lanes[width];
        a.store(lanes);
        for (int lane = 1; lane < width; ++lane) lanes[0] = lanes[lane] > lanes[0] ? lanes[lane] : lanes[0];
        return lanes[0];
    }
};

/// True if the mask is true in any lane.
template <class Isa, class Real>
LANCET_INLINE bool any(Mask<Isa, Real> mask) {
    if constexpr (Pack<Isa, Real>::one_lane) {
        return mask.value;
    } else {
        return xsimd::any(mask.value);
    }
}

/// True if the mask is true in every lane.
template <class Isa, class Real>
LANCET_INLINE bool all(Mask<Isa, Real> mask) {
    if constexpr (Pack<Isa, Real>::one_lane) {
        return mask.value;
    } else {
        return xsimd::all(mask.value);
    }
}

}  // namespace lancet::kernels
