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

/// The batches [begin, end), by one method.
template <RotationMethod method, class P>
void decompose_batches(int steps, const typename P::Real* deformation_gradient, typename P::Real* quaternion, int begin,
                       int end) {
    for (std::ptrdiff_t batch = begin; batch < end; ++batch) {
        const Matrix3<P> f = load_matrix<P>(deformation_gradient + batch * 9 * P::width);
        typename P::Real* q = quaternion + batch * 4 * P::width;
        store_quaternion(q, nearest_rotation<method>(f, load_quaternion<P>(q), steps));
    }
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
