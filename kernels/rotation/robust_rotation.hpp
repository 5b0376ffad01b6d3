#pragma once

#include "lancet/kernels/rotation/svd.hpp"

namespace lancet::kernels {

/// The rotation that maximises tr(R^T F) to rounding, from any start, a good one making it fast: `steps` Newton steps
/// of the analytic polar decomposition and, while a lane has not converged, up to two more; where any lane still has
/// not (a bad start, F inverted, flat or of rank one) its batch computes the singular value decomposition, and that
/// lane takes its rotation. No lane depends on another one. `count` batches together, as in quaternion_rotations.
/// A last step of the length `longest` and less is the end: what it leaves is its cube.
template <int count, class P>
LANCET_INLINE void robust_rotations(const Matrix3<P> (&f)[count], Quaternion<P> (&q)[count], int steps,
                                    typename P::Real longest = RotationConstants<P>::cube_root_epsilon) {
    Matrix3<P> scaled[count];
    Mask<typename P::Isa, typename P::Real> converged[count];
    for (int i = 0; i < count; ++i) {
        scaled[i] = prescale(f[i]);
        const auto first = rotation_step(scaled[i], q[i], longest);
        q[i] = first.rotation;
        converged[i] = first.converged;
    }
    for (int step = 1; step < steps + 2; ++step) {
        if (step >= steps) {
            auto everywhere = converged[0];
            for (int i = 1; i < count; ++i) everywhere = everywhere & converged[i];
            if (all(everywhere)) break;
        }
        for (int i = 0; i < count; ++i) {
            const auto next = rotation_step(scaled[i], q[i], longest);
            q[i] = keep_in_range(select(converged[i], q[i], next.rotation), step);
            converged[i] = converged[i] | next.converged;
        }
    }
    for (int i = 0; i < count; ++i) {
        q[i] = normalise(q[i]);
        if (!all(converged[i])) [[unlikely]]
            q[i] = select(converged[i], q[i], distant_svd_rotation(f[i]));
    }
}

/// The same for one batch.
template <class P>
LANCET_INLINE Quaternion<P> robust_rotation(const Matrix3<P>& f, const Quaternion<P>& start, int steps) {
    const Matrix3<P> matrices[1] = {f};
    Quaternion<P> q[1] = {start};
    robust_rotations(matrices, q, steps);
    return q[0];
}

}  // namespace lancet::kernels
