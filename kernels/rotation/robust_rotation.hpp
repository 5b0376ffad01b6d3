#pragma once

#include "lancet/kernels/rotation/svd.hpp"

namespace lancet::kernels {

/// svd_rotation as a function of its own: it is rarely called where it stands.
template <class P>
[[gnu::noinline, gnu::cold]] Quaternion<P> distant_svd_rotation(const Matrix3<P>& f) {
    return svd_rotation(f);
}

/// The rotation that maximises tr(R^T F) to rounding, from any start, a good one making it fast: `steps` Newton steps
/// of the analytic polar decomposition and, while a lane of the batch has not converged, up to two more; where any lane
/// still has not (a bad start, F inverted, flat or of rank one) the batch computes the singular value decomposition,
/// and those lanes take its rotation. No lane depends on another one.
template <class P>
LANCET_INLINE Quaternion<P> robust_rotation(const Matrix3<P>& f, const Quaternion<P>& start, int steps) {
    const Matrix3<P> scaled = prescale(f);
    RotationStep<P> last = rotation_step(scaled, start);
    last.rotation = normalise(last.rotation);
    for (int step = 1; step < steps + 2; ++step) {
        if (step >= steps && all(last.converged)) return last.rotation;
        auto next = rotation_step(scaled, last.rotation);
        next.rotation = normalise(next.rotation);
        last.rotation = select(last.converged, last.rotation, next.rotation);
        last.converged = last.converged | next.converged;
    }
    if (all(last.converged)) return last.rotation;
    return select(last.converged, last.rotation, distant_svd_rotation(f));
}

}  // namespace lancet::kernels
