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

/// x_j - x_0 of a batch.
template <class P>
LANCET_INLINE Corners<P> load_corner_differences(const TetrahedronArguments<typename P::Real>& a, std::int64_t batch) {
    const std::int32_t* nodes = a.nodes + batch * 4 * P::width;
    Corners<P> d;
    for (int j = 0; j < 3; ++j) d.of[j] = load_differences<P>(a.positions, nodes + (j + 1) * P::width, nodes);
    return d;
}

/// The energy of the batches [first, first + count) and nothing else: it needs neither the rotated gradients nor a
/// rotation to the last digit.
template <class P, RotationMethod method, int count>
LANCET_INLINE void energy_together(const TetrahedronArguments<typename P::Real>& a, std::int64_t first, P& energy) {
    constexpr int W = P::width;
    constexpr int entries = ElementBatches<typename P::Real>::rest_entries;
    Matrix3<P> deformation[count];
    Quaternion<P> q[count];
    for (int k = 0; k < count; ++k) {
        const Corners<P> b = load_corners<P>(a.rest + (first + k) * entries * W);
        deformation[k] = gradient(load_corner_differences<P>(a, first + k), b);
        q[k] = load_quaternion<P>(a.quaternion + (first + k) * 4 * W);
    }
    nearest_rotations_for_energy<method>(deformation, q, a.rotation_steps);
    for (int k = 0; k < count; ++k) {
        store_quaternion(a.quaternion + (first + k) * 4 * W, q[k]);
        const typename P::Real* rest = a.rest + (first + k) * entries * W;
        energy += corotational_energy(deformation[k], to_matrix(q[k]), P::load(rest + 9 * W), P::load(rest + 10 * W));
    }
}

/// Rotated gradients, force and energy of the batches [first, first + count), which are rotated together. The rotation
/// method is a constant of the compilation; with UpdateRotation false the gradients that are stored are read instead.
template <class P, bool UpdateRotation, RotationMethod method, int count>
LANCET_INLINE void elastic_together(const TetrahedronArguments<typename P::Real>& a, std::int64_t first, P& energy) {
    using Real = typename P::Real;
    constexpr int W = P::width;
    const bool in_batches = a.layout == GradientLayout::batches;
    Corners<P> d[count], b[count];
    for (int k = 0; k < count; ++k) d[k] = load_corner_differences<P>(a, first + k);
    if constexpr (UpdateRotation) {
        Matrix3<P> deformation[count];
        Quaternion<P> q[count];
        for (int k = 0; k < count; ++k) {
            b[k] = load_corners<P>(a.rest + (first + k) * ElementBatches<Real>::rest_entries * W);
            deformation[k] = gradient(d[k], b[k]);
            q[k] = load_quaternion<P>(a.quaternion + (first + k) * 4 * W);
        }
        nearest_rotations<method>(deformation, q, a.rotation_steps);
        for (int k = 0; k < count; ++k) {
            store_quaternion(a.quaternion + (first + k) * 4 * W, q[k]);
            const Real* rest = a.rest + (first + k) * ElementBatches<Real>::rest_entries * W;
            const Matrix3<P> r = scale(to_matrix(q[k]), P::load(rest + 9 * W));
            for (int j = 0; j < 3; ++j) b[k].of[j] = multiply(r, b[k].of[j]);
            if (a.rotated == nullptr) continue;
            if (in_batches) {
                store_corners(a.rotated + (first + k) * 9 * W, b[k]);
            } else {
                store_gradient_corners(a.rotated + (first + k) * 16 * W, b[k], P::load(rest + 10 * W));
            }
        }
    } else {
        for (int k = 0; k < count; ++k) {
            b[k] = in_batches ? load_corners<P>(a.rotated + (first + k) * 9 * W)
                              : load_gradient_corners<P>(a.rotated + (first + k) * 16 * W);
        }
    }
    if (a.force == nullptr && a.energy == nullptr) return;
    for (int k = 0; k < count; ++k) {
        // sqrt(V mu) G, so that stress times gradient carries V mu once.
        const Real* rest = a.rest + (first + k) * ElementBatches<Real>::rest_entries * W;
        const P root = P::load(rest + 9 * W);
        Matrix3<P> g = gradient(d[k], b[k]);
        for (int i = 0; i < 3; ++i) g.entry[i][i] -= root;
        const Symmetric3<P> stress = hooke_stress(g, P::load(rest + 10 * W));
        if (a.energy != nullptr) energy += hooke_energy(g, stress);
        if (a.force == nullptr) continue;
        Corners<P> f;
        for (int j = 0; j < 3; ++j) {
            const Vector3<P> pull = multiply(stress, b[k].of[j]);
            f.of[j] = {-pull.x, -pull.y, -pull.z};
        }
        scatter(a.force, a.targets + (first + k) * 4 * W, f, a.exclusive_slots);
    }
}

/// The loop of TetrahedronKernels::elastic for one rotation method.
template <class P, bool UpdateRotation, RotationMethod method>
void elastic_loop(const TetrahedronArguments<typename P::Real>& a, int block) {
    constexpr int together = UpdateRotation ? batches_together<method> : 1;
    P energy(typename P::Real(0));
    std::int64_t batch = a.block_batch_begin[block];
    const std::int64_t end = a.block_batch_begin[block + 1];
    if constexpr (UpdateRotation) {
        if (a.energy != nullptr && a.force == nullptr && a.rotated == nullptr) {
            for (; batch + together <= end; batch += together) energy_together<P, method, together>(a, batch, energy);
            for (; batch < end; ++batch) energy_together<P, method, 1>(a, batch, energy);
        }
    }
    for (; batch + together <= end; batch += together) {
        elastic_together<P, UpdateRotation, method, together>(a, batch, energy);
    }
    for (; batch < end; ++batch) elastic_together<P, UpdateRotation, method, 1>(a, batch, energy);
    if (a.energy != nullptr) a.energy[block] = static_cast<double>(sum(energy));
}

template <class P>
void elastic(const TetrahedronArguments<typename P::Real>& a, int block) {
    if (!a.update_rotation) return elastic_loop<P, false, RotationMethod::quaternion>(a, block);
    switch (a.method) {
        case RotationMethod::quaternion:
            return elastic_loop<P, true, RotationMethod::quaternion>(a, block);
        case RotationMethod::robust:
            return elastic_loop<P, true, RotationMethod::robust>(a, block);
        case RotationMethod::polar:
            return elastic_loop<P, true, RotationMethod::polar>(a, block);
        case RotationMethod::svd:
            return elastic_loop<P, true, RotationMethod::svd>(a, block);
    }
}

template <class P>
constexpr TetrahedronKernels<typename P::Real> make_tetrahedron_kernels() {
    return {.elastic = &elastic<P>};
}

}  // namespace lancet::kernels
