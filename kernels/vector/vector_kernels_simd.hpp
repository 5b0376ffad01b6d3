#pragma once

#include "lancet/kernels/simd/nodes.hpp"
#include "lancet/kernels/vector/vector_kernels.hpp"

namespace lancet::kernels {

/// Reads `A::width` numbers of another scalar type.
template <class A, class Real>
LANCET_INLINE A load_as(const Real* source) {
    if constexpr (sizeof(Real) == sizeof(typename A::Real)) {
        return A::load(source);
    } else {
        typename A::Real lanes[A::width];
        for (int lane = 0; lane < A::width; ++lane) lanes[lane] = static_cast<typename A::Real>(source[lane]);
        return A::load(lanes);
    }
}

/// Reads `P::width` consecutive nodes of a nodal vector of another scalar type.
template <class P, class Accumulate>
LANCET_INLINE Vector3<P> load_nodes_as(const Accumulate* nodal) {
    if constexpr (sizeof(Accumulate) == sizeof(typename P::Real)) {
        return load_nodes<P>(nodal);
    } else {
        Quad<typename P::Isa, typename P::Real> quads[P::width];
        for (int lane = 0; lane < P::width; ++lane) {
            quads[lane] = narrow(Quad<typename P::Isa, double>::load(nodal + 4 * lane));
        }
        P c[4];
        transpose(quads, c);
        return {c[0], c[1], c[2]};
    }
}

template <class P, class A>
struct VectorPass {
    using Real = typename P::Real;
    using Accumulate = typename A::Real;
    using Arguments = ConjugateGradientArguments<Real, Accumulate>;
    static constexpr int group = 4 * P::width;  ///< numbers of a group of `width` nodes

    struct Products {
        A r_dot_z{Accumulate(0)};
        A r_dot_r{Accumulate(0)};
    };

    LANCET_INLINE static void update_group(const Arguments& a, std::int64_t at) {
        const A alpha(a.alpha), beta(a.beta);
        for (std::int64_t i = at; i < at + group; i += A::width) {
            const A p = fma(beta, A::load(a.p + i), load_as<A>(a.z + i));
            const A s = fma(beta, A::load(a.s + i), load_as<A>(a.w + i));
            p.store(a.p + i);
            s.store(a.s + i);
            fma(alpha, p, A::load(a.x + i)).store(a.x + i);
            fnma(alpha, s, A::load(a.r + i)).store(a.r + i);
        }
    }

    LANCET_INLINE static Vector3<P> smooth(const Arguments& a, std::int64_t at) {
        const Vector3<P> r = load_nodes_as<P>(a.r + at);
        if (a.inverse_diagonal == nullptr) return r;
        const Real* b = a.inverse_diagonal + (at / group) * 6 * P::width;
        const P xx = P::load(b), yy = P::load(b + P::width), zz = P::load(b + 2 * P::width);
        const P xy = P::load(b + 3 * P::width), xz = P::load(b + 4 * P::width), yz = P::load(b + 5 * P::width);
        return {fma(xz, r.z, fma(xy, r.y, xx * r.x)), fma(yz, r.z, fma(yy, r.y, xy * r.x)),
                fma(zz, r.z, fma(yz, r.y, xz * r.x))};
    }

    LANCET_INLINE static void multiply_group(const Arguments& a, std::int64_t at, Products& products) {
        for (std::int64_t i = at; i < at + group; i += A::width) {
            const A r = A::load(a.r + i);
            products.r_dot_z = fma(r, load_as<A>(a.z + i), products.r_dot_z);
            products.r_dot_r = fma(r, r, products.r_dot_r);
        }
    }

    LANCET_INLINE static void finish(const Arguments& a, int block, const Products& products) {
        a.r_dot_z[block] = static_cast<double>(sum(products.r_dot_z));
        a.r_dot_r[block] = static_cast<double>(sum(products.r_dot_r));
    }

    template <bool Update, bool Precondition>
    static void run(const Arguments& a, int block) {
        Products products;
        const std::int64_t end = 4 * static_cast<std::int64_t>(a.block_begin[block + 1]);
        for (std::int64_t at = 4 * static_cast<std::int64_t>(a.block_begin[block]); at < end; at += group) {
            if constexpr (Update) update_group(a, at);
            if constexpr (Precondition) {
                store_nodes(a.z + at, smooth(a, at));
                multiply_group(a, at, products);
            }
        }
        if constexpr (Precondition) finish(a, block, products);
    }

    static void restrict_residual(const CoarseArguments<Real>& c, const Arguments& a, int block) {
        for (std::int32_t g = c.block_aggregate_begin[block]; g < c.block_aggregate_begin[block + 1]; ++g) {
            const P zero(Real(0));
            P moments[6] = {zero, zero, zero, zero, zero, zero};
            const std::int64_t end = 4 * static_cast<std::int64_t>(c.aggregate_begin[g + 1]);
            for (std::int64_t at = 4 * static_cast<std::int64_t>(c.aggregate_begin[g]); at < end; at += group) {
                const Vector3<P> r = load_nodes_as<P>(a.r + at), d = load_nodes<P>(c.offset + at);
                moments[0] += r.x;
                moments[1] += r.y;
                moments[2] += r.z;
                moments[3] = fnma(d.z, r.y, fma(d.y, r.z, moments[3]));
                moments[4] = fnma(d.x, r.z, fma(d.z, r.x, moments[4]));
                moments[5] = fnma(d.y, r.x, fma(d.x, r.y, moments[5]));
            }
            for (int mode = 0; mode < 6; ++mode) {
                c.restricted[6 * static_cast<std::int64_t>(g) + mode] = static_cast<double>(sum(moments[mode]));
            }
        }
    }

    static void precondition_with_coarse(const CoarseArguments<Real>& c, const Arguments& a, int block) {
        Products products;
        for (std::int32_t g = c.block_aggregate_begin[block]; g < c.block_aggregate_begin[block + 1]; ++g) {
            const Real* motion = c.correction + 6 * static_cast<std::int64_t>(g);
            const P tx(motion[0]), ty(motion[1]), tz(motion[2]), wx(motion[3]), wy(motion[4]), wz(motion[5]);
            const std::int64_t end = 4 * static_cast<std::int64_t>(c.aggregate_begin[g + 1]);
            for (std::int64_t at = 4 * static_cast<std::int64_t>(c.aggregate_begin[g]); at < end; at += group) {
                const Vector3<P> z = smooth(a, at), d = load_nodes<P>(c.offset + at);
                store_nodes(a.z + at,
                            Vector3<P>{z.x + fnma(wz, d.y, fma(wy, d.z, tx)), z.y + fnma(wx, d.z, fma(wz, d.x, ty)),
                                       z.z + fnma(wy, d.x, fma(wx, d.y, tz))});
                multiply_group(a, at, products);
            }
        }
        finish(a, block, products);
    }
};

template <class P, class A>
constexpr VectorKernels<typename P::Real, typename A::Real> make_vector_kernels() {
    using Pass = VectorPass<P, A>;
    return {.update = &Pass::template run<true, false>,
            .precondition = &Pass::template run<false, true>,
            .update_and_precondition = &Pass::template run<true, true>,
            .restrict_residual = &Pass::restrict_residual,
            .precondition_with_coarse = &Pass::precondition_with_coarse};
}

}  // namespace lancet::kernels
