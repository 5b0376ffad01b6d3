#pragma once

// Included by quad.hpp: quads and their transposes in SSE2, AVX2 and AVX-512 registers.

namespace lancet::kernels {

/// Four floats in one 128-bit register, on every x86 instruction set.
template <class Isa>
struct FloatQuad {
    __m128 number;

    LANCET_INLINE static Quad<Isa, float> load(const float* source) { return {{_mm_loadu_ps(source)}}; }
    LANCET_INLINE void store(float* destination) const { _mm_storeu_ps(destination, number); }
    LANCET_INLINE friend Quad<Isa, float> operator+(Quad<Isa, float> a, Quad<Isa, float> b) {
        return {{_mm_add_ps(a.number, b.number)}};
    }
    LANCET_INLINE friend Quad<Isa, float> operator-(Quad<Isa, float> a, Quad<Isa, float> b) {
        return {{_mm_sub_ps(a.number, b.number)}};
    }
};

template <>
struct Quad<isa::sse2, float> : FloatQuad<isa::sse2> {};

template <>
struct Quad<isa::sse2, double> {
    __m128d low, high;

    LANCET_INLINE static Quad load(const double* source) { return {_mm_loadu_pd(source), _mm_loadu_pd(source + 2)}; }
    LANCET_INLINE void store(double* destination) const {
        _mm_storeu_pd(destination, low);
        _mm_storeu_pd(destination + 2, high);
    }
    LANCET_INLINE static Quad load_three(const double* source) {
        return {_mm_loadu_pd(source), _mm_load_sd(source + 2)};
    }
    LANCET_INLINE void store_three(double* destination) const {
        _mm_storeu_pd(destination, low);
        _mm_store_sd(destination + 2, high);
    }
    LANCET_INLINE friend Quad operator+(Quad a, Quad b) {
        return {_mm_add_pd(a.low, b.low), _mm_add_pd(a.high, b.high)};
    }
    LANCET_INLINE friend Quad operator-(Quad a, Quad b) {
        return {_mm_sub_pd(a.low, b.low), _mm_sub_pd(a.high, b.high)};
    }
};

LANCET_INLINE Quad<isa::sse2, float> narrow(Quad<isa::sse2, double> a) {
    return {{_mm_movelh_ps(_mm_cvtpd_ps(a.low), _mm_cvtpd_ps(a.high))}};
}
LANCET_INLINE Quad<isa::sse2, double> widen(Quad<isa::sse2, float> a) {
    return {_mm_cvtps_pd(a.number), _mm_cvtps_pd(_mm_movehl_ps(a.number, a.number))};
}

LANCET_INLINE void transpose(const Quad<isa::sse2, float> (&q)[4], Pack<isa::sse2, float> (&c)[4]) {
    __m128 r0 = q[0].number, r1 = q[1].number, r2 = q[2].number, r3 = q[3].number;
    _MM_TRANSPOSE4_PS(r0, r1, r2, r3);
    c[0].value = r0;
    c[1].value = r1;
    c[2].value = r2;
    c[3].value = r3;
}
LANCET_INLINE void transpose(const Pack<isa::sse2, float> (&c)[4], Quad<isa::sse2, float> (&q)[4]) {
    __m128 r0 = c[0].value, r1 = c[1].value, r2 = c[2].value, r3 = c[3].value;
    _MM_TRANSPOSE4_PS(r0, r1, r2, r3);
    q[0].number = r0;
    q[1].number = r1;
    q[2].number = r2;
    q[3].number = r3;
}

LANCET_INLINE void transpose(const Quad<isa::sse2, double> (&q)[2], Pack<isa::sse2, double> (&c)[4]) {
    c[0].value = _mm_unpacklo_pd(q[0].low, q[1].low);
    c[1].value = _mm_unpackhi_pd(q[0].low, q[1].low);
    c[2].value = _mm_unpacklo_pd(q[0].high, q[1].high);
    c[3].value = _mm_unpackhi_pd(q[0].high, q[1].high);
}
LANCET_INLINE void transpose(const Pack<isa::sse2, double> (&c)[4], Quad<isa::sse2, double> (&q)[2]) {
    q[0] = {_mm_unpacklo_pd(c[0].value, c[1].value), _mm_unpacklo_pd(c[2].value, c[3].value)};
    q[1] = {_mm_unpackhi_pd(c[0].value, c[1].value), _mm_unpackhi_pd(c[2].value, c[3].value)};
}

#if defined(__AVX2__)

/// Four doubles in one 256-bit register, on AVX2 and AVX-512.
template <class Isa>
struct DoubleQuad {
    __m256d number;

    LANCET_INLINE static Quad<Isa, double> load(const double* source) { return {{_mm256_loadu_pd(source)}}; }
    LANCET_INLINE void store(double* destination) const { _mm256_storeu_pd(destination, number); }
    LANCET_INLINE static Quad<Isa, double> load_three(const double* source) {
        return {{_mm256_maskload_pd(source, _mm256_set_epi64x(0, -1, -1, -1))}};
    }
    LANCET_INLINE void store_three(double* destination) const {
        _mm_storeu_pd(destination, _mm256_castpd256_pd128(number));
        _mm_store_sd(destination + 2, _mm256_extractf128_pd(number, 1));
    }
    LANCET_INLINE friend Quad<Isa, double> operator+(Quad<Isa, double> a, Quad<Isa, double> b) {
        return {{_mm256_add_pd(a.number, b.number)}};
    }
    LANCET_INLINE friend Quad<Isa, double> operator-(Quad<Isa, double> a, Quad<Isa, double> b) {
        return {{_mm256_sub_pd(a.number, b.number)}};
    }
};

template <>
struct Quad<isa::avx2, float> : FloatQuad<isa::avx2> {};
template <>
struct Quad<isa::avx2, double> : DoubleQuad<isa::avx2> {};

LANCET_INLINE Quad<isa::avx2, float> narrow(Quad<isa::avx2, double> a) {
    return {{_mm256_cvtpd_ps(a.number)}};
}
LANCET_INLINE Quad<isa::avx2, double> widen(Quad<isa::avx2, float> a) {
    return {{_mm256_cvtps_pd(a.number)}};
}

/// The 4 x 4 transpose within each 128-bit part of four registers.
LANCET_INLINE void transpose_parts(__m256& r0, __m256& r1, __m256& r2, __m256& r3) {
    const __m256 a = _mm256_unpacklo_ps(r0, r1), b = _mm256_unpackhi_ps(r0, r1);
    const __m256 c = _mm256_unpacklo_ps(r2, r3), d = _mm256_unpackhi_ps(r2, r3);
    r0 = _mm256_shuffle_ps(a, c, 0x44);
    r1 = _mm256_shuffle_ps(a, c, 0xEE);
    r2 = _mm256_shuffle_ps(b, d, 0x44);
    r3 = _mm256_shuffle_ps(b, d, 0xEE);
}

LANCET_INLINE void transpose(const Quad<isa::avx2, float> (&q)[8], Pack<isa::avx2, float> (&c)[4]) {
    __m256 r[4];
    for (int i = 0; i < 4; ++i) {
        r[i] = _mm256_insertf128_ps(_mm256_castps128_ps256(q[i].number), q[i + 4].number, 1);
    }
    transpose_parts(r[0], r[1], r[2], r[3]);
    for (int i = 0; i < 4; ++i) c[i].value = r[i];
}
LANCET_INLINE void transpose(const Pack<isa::avx2, float> (&c)[4], Quad<isa::avx2, float> (&q)[8]) {
    __m256 r[4];
    for (int i = 0; i < 4; ++i) r[i] = c[i].value;
    transpose_parts(r[0], r[1], r[2], r[3]);
    for (int i = 0; i < 4; ++i) {
        q[i].number = _mm256_castps256_ps128(r[i]);
        q[i + 4].number = _mm256_extractf128_ps(r[i], 1);
    }
}

/// The 4 x 4 transpose of doubles.
LANCET_INLINE void transpose_doubles(__m256d& r0, __m256d& r1, __m256d& r2, __m256d& r3) {
    const __m256d a = _mm256_unpacklo_pd(r0, r1), b = _mm256_unpackhi_pd(r0, r1);
    const __m256d c = _mm256_unpacklo_pd(r2, r3), d = _mm256_unpackhi_pd(r2, r3);
    r0 = _mm256_permute2f128_pd(a, c, 0x20);
    r1 = _mm256_permute2f128_pd(b, d, 0x20);
    r2 = _mm256_permute2f128_pd(a, c, 0x31);
    r3 = _mm256_permute2f128_pd(b, d, 0x31);
}

LANCET_INLINE void transpose(const Quad<isa::avx2, double> (&q)[4], Pack<isa::avx2, double> (&c)[4]) {
    __m256d r0 = q[0].number, r1 = q[1].number, r2 = q[2].number, r3 = q[3].number;
    transpose_doubles(r0, r1, r2, r3);
    c[0].value = r0;
    c[1].value = r1;
    c[2].value = r2;
    c[3].value = r3;
}
LANCET_INLINE void transpose(const Pack<isa::avx2, double> (&c)[4], Quad<isa::avx2, double> (&q)[4]) {
    __m256d r0 = c[0].value, r1 = c[1].value, r2 = c[2].value, r3 = c[3].value;
    transpose_doubles(r0, r1, r2, r3);
    q[0].number = r0;
    q[1].number = r1;
    q[2].number = r2;
    q[3].number = r3;
}

#endif  // AVX2

#if defined(__AVX512F__) && defined(__AVX512DQ__)

template <>
struct Quad<isa::avx512, float> : FloatQuad<isa::avx512> {};
template <>
struct Quad<isa::avx512, double> : DoubleQuad<isa::avx512> {};

LANCET_INLINE Quad<isa::avx512, float> narrow(Quad<isa::avx512, double> a) {
    return {{_mm256_cvtpd_ps(a.number)}};
}
LANCET_INLINE Quad<isa::avx512, double> widen(Quad<isa::avx512, float> a) {
    return {{_mm256_cvtps_pd(a.number)}};
}

/// The 4 x 4 transpose within each 128-bit part of four registers.
LANCET_INLINE void transpose_parts(__m512& r0, __m512& r1, __m512& r2, __m512& r3) {
    const __m512 a = _mm512_unpacklo_ps(r0, r1), b = _mm512_unpackhi_ps(r0, r1);
    const __m512 c = _mm512_unpacklo_ps(r2, r3), d = _mm512_unpackhi_ps(r2, r3);
    r0 = _mm512_shuffle_ps(a, c, 0x44);
    r1 = _mm512_shuffle_ps(a, c, 0xEE);
    r2 = _mm512_shuffle_ps(b, d, 0x44);
    r3 = _mm512_shuffle_ps(b, d, 0xEE);
}

LANCET_INLINE void transpose(const Quad<isa::avx512, float> (&q)[16], Pack<isa::avx512, float> (&c)[4]) {
    __m512 r[4];
    for (int i = 0; i < 4; ++i) {
        r[i] = _mm512_castps128_ps512(q[i].number);
        r[i] = _mm512_insertf32x4(r[i], q[i + 4].number, 1);
        r[i] = _mm512_insertf32x4(r[i], q[i + 8].number, 2);
        r[i] = _mm512_insertf32x4(r[i], q[i + 12].number, 3);
    }
    transpose_parts(r[0], r[1], r[2], r[3]);
    for (int i = 0; i < 4; ++i) c[i].value = r[i];
}
LANCET_INLINE void transpose(const Pack<isa::avx512, float> (&c)[4], Quad<isa::avx512, float> (&q)[16]) {
    __m512 r[4];
    for (int i = 0; i < 4; ++i) r[i] = c[i].value;
    transpose_parts(r[0], r[1], r[2], r[3]);
    for (int i = 0; i < 4; ++i) {
        q[i].number = _mm512_castps512_ps128(r[i]);
        q[i + 4].number = _mm512_extractf32x4_ps(r[i], 1);
        q[i + 8].number = _mm512_extractf32x4_ps(r[i], 2);
        q[i + 12].number = _mm512_extractf32x4_ps(r[i], 3);
    }
}

LANCET_INLINE void transpose(const Quad<isa::avx512, double> (&q)[8], Pack<isa::avx512, double> (&c)[4]) {
    __m256d half[2][4];
    for (int h = 0; h < 2; ++h) {
        for (int i = 0; i < 4; ++i) half[h][i] = q[4 * h + i].number;
        transpose_doubles(half[h][0], half[h][1], half[h][2], half[h][3]);
    }
    for (int i = 0; i < 4; ++i) {
        c[i].value = _mm512_insertf64x4(_mm512_castpd256_pd512(half[0][i]), half[1][i], 1);
    }
}
LANCET_INLINE void transpose(const Pack<isa::avx512, double> (&c)[4], Quad<isa::avx512, double> (&q)[8]) {
    __m256d half[2][4];
    for (int i = 0; i < 4; ++i) {
        half[0][i] = _mm512_castpd512_pd256(c[i].value);
        half[1][i] = _mm512_extractf64x4_pd(c[i].value, 1);
    }
    for (int h = 0; h < 2; ++h) {
        transpose_doubles(half[h][0], half[h][1], half[h][2], half[h][3]);
        for (int i = 0; i < 4; ++i) q[4 * h + i].number = half[h][i];
    }
}

#endif  // AVX-512

}  // namespace lancet::kernels
