#pragma once

#include "lancet/kernels/element/tetrahedron_geometry_simd.hpp"
#include "lancet/kernels/element/tetrahedron_kernels.hpp"
#include "lancet/kernels/material/hooke.hpp"
#include "lancet/kernels/rotation/rotation_kernels_simd.hpp"

namespace lancet::kernels {

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
        deformation[k] = gradient(load_corner_differences<P>(a.positions, a.nodes + (first + k) * 4 * W), b);
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
    for (int k = 0; k < count; ++k) d[k] = load_corner_differences<P>(a.positions, a.nodes + (first + k) * 4 * W);
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
