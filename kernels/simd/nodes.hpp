#pragma once

#include "lancet/kernels/simd/quad.hpp"

namespace lancet::kernels {

/// A vector of space in every lane.
template <class P>
struct Vector3 {
    P x, y, z;
};

// Nodes are named by the place where their numbers begin in a nodal vector, 4 times their number: that is what an
// address is computed from, and it is computed often.

/// Reads the nodes at place[0..width) of an xyz_ nodal vector: register loads and a transpose, which on every machine
/// measured beats the gather instruction.
template <class P>
LANCET_INLINE Vector3<P> load_nodes(const typename P::Real* nodal, const std::int32_t* place) {
    Quad<typename P::Isa, typename P::Real> quads[P::width];
    for (int lane = 0; lane < P::width; ++lane) {
        quads[lane] = Quad<typename P::Isa, typename P::Real>::load(nodal + static_cast<std::int64_t>(place[lane]));
    }
    P c[4];
    transpose(quads, c);
    return {c[0], c[1], c[2]};
}

/// Reads `width` consecutive nodes.
template <class P>
LANCET_INLINE Vector3<P> load_nodes(const typename P::Real* nodal) {
    Quad<typename P::Isa, typename P::Real> quads[P::width];
    for (int lane = 0; lane < P::width; ++lane) {
        quads[lane] = Quad<typename P::Isa, typename P::Real>::load(nodal + 4 * lane);
    }
    P c[4];
    transpose(quads, c);
    return {c[0], c[1], c[2]};
}

/// Writes `width` consecutive nodes; the spare number becomes zero.
template <class P>
LANCET_INLINE void store_nodes(typename P::Real* nodal, Vector3<P> v) {
    Quad<typename P::Isa, typename P::Real> quads[P::width];
    const P c[4] = {v.x, v.y, v.z, P(typename P::Real(0))};
    transpose(c, quads);
    for (int lane = 0; lane < P::width; ++lane) quads[lane].store(nodal + 4 * lane);
}

/// Writes the nodes at place[0..width); the spare number becomes zero.
template <class P>
LANCET_INLINE void store_nodes(typename P::Real* nodal, const std::int32_t* place, Vector3<P> v) {
    Quad<typename P::Isa, typename P::Real> quads[P::width];
    const P c[4] = {v.x, v.y, v.z, P(typename P::Real(0))};
    transpose(c, quads);
    for (int lane = 0; lane < P::width; ++lane) quads[lane].store(nodal + static_cast<std::int64_t>(place[lane]));
}

/// Adds to the nodes at place[0..width), lane after lane, so that lanes may share a node.
template <class P>
LANCET_INLINE void add_to_nodes(typename P::Real* nodal, const std::int32_t* place, Vector3<P> v) {
    using Q = Quad<typename P::Isa, typename P::Real>;
    Q quads[P::width];
    const P c[4] = {v.x, v.y, v.z, P(typename P::Real(0))};
    transpose(c, quads);
    for (int lane = 0; lane < P::width; ++lane) {
        typename P::Real* node = nodal + static_cast<std::int64_t>(place[lane]);
        (Q::load(node) + quads[lane]).store(node);
    }
}

/// The nodes at place less those at origin, the difference formed in double and then rounded to the scalar of the pack:
/// what keeps strains accurate far from the origin of space.
template <class P>
LANCET_INLINE Vector3<P> load_differences(const double* nodal, const std::int32_t* place, const std::int32_t* origin) {
    using Isa = typename P::Isa;
    Quad<Isa, typename P::Real> quads[P::width];
    for (int lane = 0; lane < P::width; ++lane) {
        const auto difference = Quad<Isa, double>::load(nodal + static_cast<std::int64_t>(place[lane])) -
                                Quad<Isa, double>::load(nodal + static_cast<std::int64_t>(origin[lane]));
        if constexpr (sizeof(typename P::Real) == 4) {
            quads[lane] = narrow(difference);
        } else {
            quads[lane] = difference;
        }
    }
    P c[4];
    transpose(quads, c);
    return {c[0], c[1], c[2]};
}

}  // namespace lancet::kernels
