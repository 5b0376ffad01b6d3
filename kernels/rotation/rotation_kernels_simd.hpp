#pragma once

#include <cstddef>

#include "lancet/kernels/rotation/horn_polar.hpp"
#include "lancet/kernels/rotation/quaternion_polar.hpp"
#include "lancet/kernels/rotation/robust_rotation.hpp"
#include "lancet/kernels/rotation/rotation_kernels.hpp"
#include "lancet/kernels/rotation/svd.hpp"

namespace lancet::kernels {

/// The rotation of F by a method that is a constant of the compilation.
template <RotationMethod method, class P>
LANCET_INLINE Quaternion<P> nearest_rotation(const Matrix3<P>& f, const Quaternion<P>& start, int steps) {
    if constexpr (method == RotationMethod::quaternion) {
        return quaternion_rotation(f, start, steps);
    } else if constexpr (method == RotationMethod::polar) {
        return polar_rotation(f);
    } else if constexpr (method == RotationMethod::svd) {
        return svd_rotation(f);
    } else {
        return robust_rotation(f, start, steps);
    }
}

/// The rotations of `count` batches together, where the method gains from it; q holds the starts and takes the results.
template <RotationMethod method, int count, class P>
LANCET_INLINE void nearest_rotations(const Matrix3<P> (&f)[count], Quaternion<P> (&q)[count], int steps) {
    if constexpr (method == RotationMethod::quaternion) {
        quaternion_rotations(f, q, steps);
    } else if constexpr (method == RotationMethod::robust) {
        robust_rotations(f, q, steps);
    } else {
        for (int i = 0; i < count; ++i) q[i] = nearest_rotation<method>(f[i], q[i], steps);
    }
}

/// The same where the rotations serve for energies alone, which are least at the rotation and so forgive more.
template <RotationMethod method, int count, class P>
LANCET_INLINE void nearest_rotations_for_energy(const Matrix3<P> (&f)[count], Quaternion<P> (&q)[count], int steps) {
    if constexpr (method == RotationMethod::robust) {
        robust_rotations(f, q, 1, RotationConstants<P>::sixth_root_epsilon);
    } else {
        nearest_rotations<method>(f, q, steps);
    }
}

/// How many batches a method rotates together.
template <RotationMethod method>
constexpr int batches_together = method == RotationMethod::quaternion || method == RotationMethod::robust ? 2 : 1;

/// The batches [batch, batch + count), by one method.
template <RotationMethod method, int count, class P>
LANCET_INLINE void decompose_together(int steps, const typename P::Real* deformation_gradient,
                                      typename P::Real* quaternion, std::ptrdiff_t batch) {
    Matrix3<P> f[count];
    Quaternion<P> q[count];
    for (int i = 0; i < count; ++i) {
        f[i] = load_matrix<P>(deformation_gradient + (batch + i) * 9 * P::width);
        q[i] = load_quaternion<P>(quaternion + (batch + i) * 4 * P::width);
    }
    nearest_rotations<method>(f, q, steps);
    for (int i = 0; i < count; ++i) store_quaternion(quaternion + (batch + i) * 4 * P::width, q[i]);
}

/// The batches [begin, end), by one method.
template <RotationMethod method, class P>
void decompose_batches(int steps, const typename P::Real* deformation_gradient, typename P::Real* quaternion, int begin,
                       int end) {
    constexpr int together = batches_together<method>;
    std::ptrdiff_t batch = begin;
    for (; batch + together <= end; batch += together) {
        decompose_together<method, together, P>(steps, deformation_gradient, quaternion, batch);
    }
    for (; batch < end; ++batch) decompose_together<method, 1, P>(steps, deformation_gradient, quaternion, batch);
}

template <class P>
void decompose(RotationMethod method, int steps, const typename P::Real* deformation_gradient,
               typename P::Real* quaternion, int begin, int end) {
    switch (method) {
        case RotationMethod::quaternion:
            return decompose_batches<RotationMethod::quaternion, P>(steps, deformation_gradient, quaternion, begin,
                                                                    end);
        case RotationMethod::polar:
            return decompose_batches<RotationMethod::polar, P>(steps, deformation_gradient, quaternion, begin, end);
        case RotationMethod::svd:
            return decompose_batches<RotationMethod::svd, P>(steps, deformation_gradient, quaternion, begin, end);
        case RotationMethod::robust:
            return decompose_batches<RotationMethod::robust, P>(steps, deformation_gradient, quaternion, begin, end);
    }
}

template <class P>
constexpr RotationKernels<typename P::Real> make_rotation_kernels() {
    return {.decompose = &decompose<P>};
}

}  // namespace lancet::kernels
