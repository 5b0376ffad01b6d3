#pragma once

#include <cstddef>
#include <cstdint>

#include "lancet/kernels/simd/nodes.hpp"
#include "lancet/kernels/surface/normal_kernels.hpp"

namespace lancet::kernels {

/// An angle over its sine, by its cosine c >= -1/4, as a function of t = c - 3/8: the polynomial of degree 10 whose
/// largest relative error is smallest, 7.6e-8 (by Remez' algorithm).
template <class P>
LANCET_INLINE P angle_over_sine(P t) {
    const P t2 = t * t, t4 = t2 * t2, t8 = t4 * t4;
    const P a = fma(P(-0x1.35da8ep-1f), t, P(0x1.47a07ep+0f));
    const P b = fma(P(-0x1.ba4098p-3f), t, P(0x1.64dadp-2f));
    const P c = fma(P(-0x1.7ccc76p-4f), t, P(0x1.1cd11ap-3f));
    const P d = fma(P(-0x1.205934p-5f), t, P(0x1.00742cp-4f));
    const P e = fma(P(0x1.961916p-6f), t2, fma(P(-0x1.1a722ap-5f), t, P(0x1.7b9e6p-6f)));
    return fma(e, t8, fma(fma(d, t2, c), t4, fma(b, t2, a)));
}

/// The unit vector along an edge; zero for that from a vertex to itself.
template <class P>
LANCET_INLINE Vector3<P> direction(Vector3<P> edge) {
    using Real = typename P::Real;
    constexpr Real least = 1e-36f;
    const P square = fma(edge.x, edge.x, fma(edge.y, edge.y, edge.z * edge.z));
    const P scale = select(square < P(least), P(Real(0)), P(Real(1)) / sqrt(square));
    return {edge.x * scale, edge.y * scale, edge.z * scale};
}

/// The sum at the vertices of as many lanes as a pack has.
template <class P>
class NormalSum {
    using Real = typename P::Real;

  public:
    /// Takes the direction to the first neighbour up.
    LANCET_INLINE void begin(Vector3<P> first) { before_ = first; }

    /// Adds the triangle between the last neighbour and the one in the direction b.
    LANCET_INLINE void add(Vector3<P> b) {
        constexpr Real middle = 0.375f, least = -0.25f;  // of the cosines that angle_over_sine is for
        const Vector3<P> a = before_;
        const Vector3<P> normal{fnma(a.z, b.y, a.y * b.z), fnma(a.x, b.z, a.z * b.x), fnma(a.y, b.x, a.x * b.y)};
        P t = fma(a.x, b.x, fma(a.y, b.y, fma(a.z, b.z, P(-middle))));
        const auto is_obtuse = t < P(least - middle);
        P weight;
        if (any(is_obtuse)) {
            // The angle is what its neighbour leaves of pi. Flat ones make a sum that is no number.
            constexpr Real pi = 3.14159265f, least_square = 4.4e-4f, none = __builtin_nanf("");
            t = select(is_obtuse, P(-2 * middle) - t, t);
            const P square = fma(normal.x, normal.x, fma(normal.y, normal.y, normal.z * normal.z));
            const P over_sine = select(square > P(least_square), P(pi) / sqrt(square), P(none));
            weight = angle_over_sine(t);
            weight = select(is_obtuse, over_sine - weight, weight);
        } else {
            weight = angle_over_sine(t);
        }
        sum_ = {fma(weight, normal.x, sum_.x), fma(weight, normal.y, sum_.y), fma(weight, normal.z, sum_.z)};
        before_ = b;
    }

    LANCET_INLINE Vector3<P> sum() const { return sum_; }

  private:
    Vector3<P> before_{P(Real(0)), P(Real(0)), P(Real(0))}, sum_{P(Real(0)), P(Real(0)), P(Real(0))};
};

/// The lanes [first, first + width) of a batch; returns the bits of those that are doubtful.
template <class P>
LANCET_INLINE unsigned normals_of_lanes(const VertexNormalArguments& a, std::ptrdiff_t batch, int first) {
    using Real = typename P::Real;
    constexpr std::ptrdiff_t lanes = ring_lanes;
    const std::int32_t* const vertex = a.vertices + batch * lanes + first;
    const RowDifferences<P> from(a.positions, vertex);
    NormalSum<P> normal;
    const std::ptrdiff_t begin = a.slot_begin[batch], end = a.slot_begin[batch + 1];
    // What comes first in all slots, then the next: what follows from each other in one slot is waited for.
    constexpr std::ptrdiff_t together = 16;
    Vector3<P> edges[together];
    for (std::ptrdiff_t slot = begin; slot < end; slot += together) {
        const std::ptrdiff_t count = end - slot < together ? end - slot : together;
        for (std::ptrdiff_t k = 0; k < count; ++k) edges[k] = from.to(a.neighbours + (slot + k) * lanes + first);
        for (std::ptrdiff_t k = 0; k < count; ++k) edges[k] = direction(edges[k]);
        if (slot == begin) normal.begin(edges[0]);
        for (std::ptrdiff_t k = slot == begin ? 1 : 0; k < count; ++k) normal.add(edges[k]);
    }
    constexpr Real least = 0x1p-6f;
    const Vector3<P> sum = normal.sum();
    const P square = fma(sum.x, sum.x, fma(sum.y, sum.y, sum.z * sum.z));
    const auto is_good = square >= P(least);
    const P zero(Real(0)), scale = P(Real(1)) / sqrt(square);
    store_rows(a.normals, vertex,
               Vector3<P>{select(is_good, sum.x * scale, zero), select(is_good, sum.y * scale, zero),
                          select(is_good, sum.z * scale, zero)});
    if (all(is_good)) return 0;
    Real good[P::width];
    select(is_good, P(Real(1)), zero).store(good);
    unsigned bits = 0;
    for (int lane = 0; lane < P::width; ++lane) bits |= (good[lane] == 0 ? 1U : 0U) << (first + lane);
    return bits;
}

template <class P>
void vertex_normals(const VertexNormalArguments& arguments, int begin, int end) {
    for (std::ptrdiff_t batch = begin; batch < end; ++batch) {
        unsigned doubtful = 0;
        for (int first = 0; first < ring_lanes; first += P::width) {
            doubtful |= normals_of_lanes<P>(arguments, batch, first);
        }
        arguments.doubtful[batch] = static_cast<std::uint16_t>(doubtful);
    }
}

template <class P>
constexpr NormalKernels make_normal_kernels() {
    return {.vertex_normals = &vertex_normals<P>};
}

}  // namespace lancet::kernels
