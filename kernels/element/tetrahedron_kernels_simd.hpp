#pragma once

#include "lancet/kernels/element/tetrahedron_kernels.hpp"
#include "lancet/kernels/material/hooke.hpp"
#include "lancet/kernels/rotation/rotation_kernels_simd.hpp"
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

/// Writes the four rotated gradients of each lane behind each other as xyz_; the spare number is lambda / mu.
template <class P>
LANCET_INLINE void store_gradient_corners(typename P::Real* destination, const Corners<P>& b, P lambda_over_mu) {
    using Q = Quad<typename P::Isa, typename P::Real>;
    const Vector3<P> total = b.sum();
    const Vector3<P> all[4] = {{-total.x, -total.y, -total.z}, b.of[0], b.of[1], b.of[2]};
    Q quads[4][P::width];
    for (int corner = 0; corner < 4; ++corner) {
        const P c[4] = {all[corner].x, all[corner].y, all[corner].z, lambda_over_mu};
        transpose(c, quads[corner]);
    }
    for (int lane = 0; lane < P::width; ++lane) {
        for (int corner = 0; corner < 4; ++corner) quads[corner][lane].store(destination + 16 * lane + 4 * corner);
    }
}

/// Reads back corners 1, 2, 3 of what store_gradient_corners wrote.
template <class P>
LANCET_INLINE Corners<P> load_gradient_corners(const typename P::Real* source) {
    using Q = Quad<typename P::Isa, typename P::Real>;
    Corners<P> b;
    for (int j = 0; j < 3; ++j) {
        Q quads[P::width];
        for (int lane = 0; lane < P::width; ++lane) quads[lane] = Q::load(source + 16 * lane + 4 * (j + 1));
        P c[4];
        transpose(quads, c);
        b.of[j] = {c[0], c[1], c[2]};
    }
    return b;
}

/// The loop of TetrahedronKernels::elastic for one rotation method. `Method` maps (F, start) to a quaternion.
template <class P, bool UpdateRotation, class Method>
LANCET_INLINE void elastic_loop(const TetrahedronArguments<typename P::Real>& a, int block, Method rotation) {
    using Real = typename P::Real;
    constexpr int W = P::width;
    P energy(Real(0));
    for (std::int32_t batch = a.block_batch_begin[block]; batch < a.block_batch_begin[block + 1]; ++batch) {
        const std::int64_t at = batch;
        const std::int32_t* nodes = a.nodes + at * 4 * W;
        const Real* rest = a.rest + at * ElementBatches<Real>::rest_entries * W;
        const P root = P::load(rest + 9 * W), lambda_over_mu = P::load(rest + 10 * W);

        Corners<P> d;
        for (int j = 0; j < 3; ++j) d.of[j] = load_differences<P>(a.positions, nodes + (j + 1) * W, nodes);

        Corners<P> b;
        Real* rotated = a.layout == GradientLayout::batches ? a.rotated + at * 9 * W : a.rotated + at * 16 * W;
        if constexpr (UpdateRotation) {
            b = load_corners<P>(rest);
            const Matrix3<P> deformation = gradient(d, b);
            Real* stored = a.quaternion + at * 4 * W;
            const Quaternion<P> q = rotation(deformation, load_quaternion<P>(stored));
            store_quaternion(stored, q);
            const Matrix3<P> r = scale(to_matrix(q), root);
            for (int j = 0; j < 3; ++j) b.of[j] = multiply(r, b.of[j]);
            if (a.rotated == nullptr) {
                // Nothing is kept.
            } else if (a.layout == GradientLayout::batches) {
                store_corners(rotated, b);
            } else {
                store_gradient_corners(rotated, b, lambda_over_mu);
            }
        } else {
            b = a.layout == GradientLayout::batches ? load_corners<P>(rotated) : load_gradient_corners<P>(rotated);
        }
        if (a.force == nullptr && a.energy == nullptr) continue;

        // sqrt(V mu) G, so that stress times gradient carries V mu once.
        Matrix3<P> g = gradient(d, b);
        for (int i = 0; i < 3; ++i) g.entry[i][i] -= root;
        const Symmetric3<P> stress = hooke_stress(g, lambda_over_mu);
        if (a.energy != nullptr) energy += hooke_energy(g, stress);
        if (a.force != nullptr) {
            Corners<P> f;
            for (int j = 0; j < 3; ++j) {
                const Vector3<P> pull = multiply(stress, b.of[j]);
                f.of[j] = {-pull.x, -pull.y, -pull.z};
            }
            scatter(a.force, a.targets + at * 4 * W, f, a.exclusive_slots);
        }
    }
    if (a.energy != nullptr) a.energy[block] = static_cast<double>(sum(energy));
}

template <class P>
void elastic(const TetrahedronArguments<typename P::Real>& a, int block) {
    if (!a.update_rotation) {
        elastic_loop<P, false>(a, block, [](const Matrix3<P>&, const Quaternion<P>& start) { return start; });
        return;
    }
    const int steps = a.rotation_steps;
    switch (a.method) {
        case RotationMethod::quaternion:
            elastic_loop<P, true>(a, block, [steps](const Matrix3<P>& f, const Quaternion<P>& start) {
                return quaternion_rotation(f, start, steps);
            });
            break;
        case RotationMethod::robust:
            elastic_loop<P, true>(a, block, [steps](const Matrix3<P>& f, const Quaternion<P>& start) {
                return robust_rotation(f, start, steps);
            });
            break;
        case RotationMethod::polar:
            elastic_loop<P, true>(a, block,
                                  [](const Matrix3<P>& f, const Quaternion<P>&) { return polar_rotation(f); });
            break;
        case RotationMethod::svd:
            elastic_loop<P, true>(a, block, [](const Matrix3<P>& f, const Quaternion<P>&) { return svd_rotation(f); });
            break;
    }
}

template <class P>
constexpr TetrahedronKernels<typename P::Real> make_tetrahedron_kernels() {
    return {.elastic = &elastic<P>};
}

}  // namespace lancet::kernels
