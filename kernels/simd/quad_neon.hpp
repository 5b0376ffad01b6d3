#pragma once

// Included by quad.hpp: quads and their transposes in NEON registers.

namespace lancet::kernels {

template <>
struct Quad<isa::neon, float> {
    float32x4_t number;

    LANCET_INLINE static Quad load(const float* source) { return {vld1q_f32(source)}; }
    LANCET_INLINE void store(float* destination) const { vst1q_f32(destination, number); }
    LANCET_INLINE friend Quad operator+(Quad a, Quad b) { return {vaddq_f32(a.number, b.number)}; }
    LANCET_INLINE friend Quad operator-(Quad a, Quad b) { return {vsubq_f32(a.number, b.number)}; }
};

template <>
struct Quad<isa::neon, double> {
    float64x2_t low, high;

    LANCET_INLINE static Quad load(const double* source) { return {vld1q_f64(source), vld1q_f64(source + 2)}; }
    LANCET_INLINE void store(double* destination) const {
        vst1q_f64(destination, low);
        vst1q_f64(destination + 2, high);
    }
    LANCET_INLINE static Quad load_three(const double* source) {
        return {vld1q_f64(source), vld1q_lane_f64(source + 2, vdupq_n_f64(0), 0)};
    }
    LANCET_INLINE void store_three(double* destination) const {
        vst1q_f64(destination, low);
        vst1q_lane_f64(destination + 2, high, 0);
    }
    LANCET_INLINE friend Quad operator+(Quad a, Quad b) { return {vaddq_f64(a.low, b.low), vaddq_f64(a.high, b.high)}; }
    LANCET_INLINE friend Quad operator-(Quad a, Quad b) { return {vsubq_f64(a.low, b.low), vsubq_f64(a.high, b.high)}; }
};

LANCET_INLINE Quad<isa::neon, float> narrow(Quad<isa::neon, double> a) {
    return {vcvt_high_f32_f64(vcvt_f32_f64(a.low), a.high)};
}
LANCET_INLINE Quad<isa::neon, double> widen(Quad<isa::neon, float> a) {
    return {vcvt_f64_f32(vget_low_f32(a.number)), vcvt_high_f64_f32(a.number)};
}

/// The 4 x 4 transpose of floats.
LANCET_INLINE void transpose_floats(float32x4_t& r0, float32x4_t& r1, float32x4_t& r2, float32x4_t& r3) {
    const float64x2_t a = vreinterpretq_f64_f32(vtrn1q_f32(r0, r1)), b = vreinterpretq_f64_f32(vtrn2q_f32(r0, r1));
    const float64x2_t c = vreinterpretq_f64_f32(vtrn1q_f32(r2, r3)), d = vreinterpretq_f64_f32(vtrn2q_f32(r2, r3));
    r0 = vreinterpretq_f32_f64(vtrn1q_f64(a, c));
    r1 = vreinterpretq_f32_f64(vtrn1q_f64(b, d));
    r2 = vreinterpretq_f32_f64(vtrn2q_f64(a, c));
    r3 = vreinterpretq_f32_f64(vtrn2q_f64(b, d));
}

LANCET_INLINE void transpose(const Quad<isa::neon, float> (&q)[4], Pack<isa::neon, float> (&c)[4]) {
    float32x4_t r[4] = {q[0].number, q[1].number, q[2].number, q[3].number};
    transpose_floats(r[0], r[1], r[2], r[3]);
    for (int i = 0; i < 4; ++i) c[i].value = r[i];
}
LANCET_INLINE void transpose(const Pack<isa::neon, float> (&c)[4], Quad<isa::neon, float> (&q)[4]) {
    float32x4_t r[4] = {c[0].value, c[1].value, c[2].value, c[3].value};
    transpose_floats(r[0], r[1], r[2], r[3]);
    for (int i = 0; i < 4; ++i) q[i].number = r[i];
}

LANCET_INLINE void transpose(const Quad<isa::neon, double> (&q)[2], Pack<isa::neon, double> (&c)[4]) {
    c[0].value = vtrn1q_f64(q[0].low, q[1].low);
    c[1].value = vtrn2q_f64(q[0].low, q[1].low);
    c[2].value = vtrn1q_f64(q[0].high, q[1].high);
    c[3].value = vtrn2q_f64(q[0].high, q[1].high);
}
LANCET_INLINE void transpose(const Pack<isa::neon, double> (&c)[4], Quad<isa::neon, double> (&q)[2]) {
    q[0] = {vtrn1q_f64(c[0].value, c[1].value), vtrn1q_f64(c[2].value, c[3].value)};
    q[1] = {vtrn2q_f64(c[0].value, c[1].value), vtrn2q_f64(c[2].value, c[3].value)};
}

}  // namespace lancet::kernels
