#pragma once

#include <cstdint>

#include "lancet/kernels/rotation/matrix3.hpp"
#include "lancet/kernels/simd/nodes.hpp"

namespace lancet::kernels {

/// Three vectors: of corners 1, 2, 3 of a tetrahedron. Those of corner 0 follow from the sum over all four being zero.
template <class P>
struct Corners {
    Vector3<P> of[3];

    LANCET_INLINE Vector3<P> sum() const {
        return {of[0].x + of[1].x + of[2].x, of[0].y + of[1].y + of[2].y, of[0].z + of[1].z + of[2].z};
    }
};

template <class P>
LANCET_INLINE Corners<P> load_corners(const typename P::Real* source) {
    Corners<P> corners;
    for (int j = 0; j < 3; ++j) {
        corners.of[j] = {P::load(source + (3 * j) * P::width), P::load(source + (3 * j + 1) * P::width),
                         P::load(source + (3 * j + 2) * P::width)};
    }
    return corners;
}

template <class P>
LANCET_INLINE void store_corners(typename P::Real* destination, const Corners<P>& corners) {
    for (int j = 0; j < 3; ++j) {
        corners.of[j].x.store(destination + (3 * j) * P::width);
        corners.of[j].y.store(destination + (3 * j + 1) * P::width);
        corners.of[j].z.store(destination + (3 * j + 2) * P::width);
    }
}

/// sum_j d_j b_j^T over corners 1, 2, 3, where d_j are differences to corner 0.
template <class P>
LANCET_INLINE Matrix3<P> gradient(const Corners<P>& d, const Corners<P>& b) {
    Matrix3<P> g;
    const auto row = [&](int i, P first, P second, P third) {
        g.entry[i][0] = fma(third, b.of[2].x, fma(second, b.of[1].x, first * b.of[0].x));
        g.entry[i][1] = fma(third, b.of[2].y, fma(second, b.of[1].y, first * b.of[0].y));
        g.entry[i][2] = fma(third, b.of[2].z, fma(second, b.of[1].z, first * b.of[0].z));
    };
    row(0, d.of[0].x, d.of[1].x, d.of[2].x);
    row(1, d.of[0].y, d.of[1].y, d.of[2].y);
    row(2, d.of[0].z, d.of[1].z, d.of[2].z);
    return g;
}

template <class P>
LANCET_INLINE Vector3<P> multiply(const Matrix3<P>& a, const Vector3<P>& v) {
    return {fma(a.entry[0][2], v.z, fma(a.entry[0][1], v.y, a.entry[0][0] * v.x)),
            fma(a.entry[1][2], v.z, fma(a.entry[1][1], v.y, a.entry[1][0] * v.x)),
            fma(a.entry[2][2], v.z, fma(a.entry[2][1], v.y, a.entry[2][0] * v.x))};
}

/// a^T v.
template <class P>
LANCET_INLINE Vector3<P> multiply_transposed(const Matrix3<P>& a, const Vector3<P>& v) {
    return {fma(a.entry[2][0], v.z, fma(a.entry[1][0], v.y, a.entry[0][0] * v.x)),
            fma(a.entry[2][1], v.z, fma(a.entry[1][1], v.y, a.entry[0][1] * v.x)),
            fma(a.entry[2][2], v.z, fma(a.entry[1][2], v.y, a.entry[0][2] * v.x))};
}

/// Adds (or, where each slot is written once, stores) the values of corners 1, 2, 3 and minus their sum at corner 0.
template <class P>
LANCET_INLINE void scatter(typename P::Real* buffer, const std::int32_t* targets, const Corners<P>& f,
                           bool exclusive_slots) {
    const Vector3<P> total = f.sum();
    const Vector3<P> first{-total.x, -total.y, -total.z};
    if (exclusive_slots) {
        store_nodes(buffer, targets, first);
        for (int j = 0; j < 3; ++j) store_nodes(buffer, targets + (j + 1) * P::width, f.of[j]);
    } else {
        add_to_nodes(buffer, targets, first);
        for (int j = 0; j < 3; ++j) add_to_nodes(buffer, targets + (j + 1) * P::width, f.of[j]);
    }
}

/// x_j - x_0 for the nodes [corner][lane] of a batch, the differences formed in double.
template <class P>
LANCET_INLINE Corners<P> load_corner_differences(const double* positions, const std::int32_t* nodes) {
    Corners<P> d;
    for (int j = 0; j < 3; ++j) d.of[j] = load_differences<P>(positions, nodes + (j + 1) * P::width, nodes);
    return d;
}

}  // namespace lancet::kernels
