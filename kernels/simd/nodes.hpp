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

// Rows are three numbers without a spare one, as points lie in memory. Those that are read or written here are named by
// where they begin, 3 times their number.

/// From the rows of one vertex in every lane to others: differences in double, rounded to the scalar of the pack.
template <class P>
class RowDifferences {
    using Isa = typename P::Isa;

  public:
    LANCET_INLINE RowDifferences(const double* rows, const std::int32_t* origin) : rows_(rows) {
        for (int lane = 0; lane < P::width; ++lane) origin_[lane] = load(origin[lane]);
    }

    LANCET_INLINE Vector3<P> to(const std::int32_t* place) const {
        Quad<Isa, typename P::Real> quads[P::width];
        for (int lane = 0; lane < P::width; ++lane) {
            const auto difference = load(place[lane]) - origin_[lane];
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

  private:
    LANCET_INLINE Quad<Isa, double> load(std::int32_t place) const {
        return Quad<Isa, double>::load_three(rows_ + static_cast<std::int64_t>(place));
    }

    const double* rows_;
    Quad<Isa, double> origin_[P::width];
};

/// Writes rows of doubles, and nothing beside them.
template <class P>
LANCET_INLINE void store_rows(double* rows, const std::int32_t* place, Vector3<P> v) {
    Quad<typename P::Isa, typename P::Real> quads[P::width];
    const P c[4] = {v.x, v.y, v.z, P(typename P::Real(0))};
    transpose(c, quads);
    for (int lane = 0; lane < P::width; ++lane) {
        double* const row = rows + static_cast<std::int64_t>(place[lane]);
        if constexpr (sizeof(typename P::Real) == 4) {
            widen(quads[lane]).store_three(row);
        } else {
            quads[lane].store_three(row);
        }
    }
}

}  // namespace lancet::kernels
