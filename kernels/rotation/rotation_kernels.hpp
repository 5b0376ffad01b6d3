#pragma once

#include <string_view>

namespace lancet::kernels {

/// How the rotation of a deformation gradient is found.
enum class RotationMethod {
    quaternion,  ///< Newton steps on a unit quaternion from a warm start (Kugelstadt, Koschier, Bender 2018)
    polar,       ///< the dominant eigenvector of Horn's 4 x 4 matrix; no start needed
    svd          ///< singular value decomposition with the inversion convention (McAdams et al. 2011): the reference
};

/// The rotation kernels of one instruction set.
template <class Real>
struct RotationKernels {
    /// Finds the rotation nearest to F, lane by lane, for the batches [begin, end). A proper rotation (finite,
    /// orthogonal, det +1) results for every finite F.
    /// - deformation_gradient: [batch][row-major 3 x 3 entry][lane]
    /// - quaternion: [batch][w, x, y, z][lane], unit; the start on entry (method quaternion only), the rotation on exit
    /// - steps: Newton steps of method quaternion; the other methods do not read it
    void (*decompose)(RotationMethod method, int steps, const Real* deformation_gradient, Real* quaternion, int begin,
                      int end);
};

}  // namespace lancet::kernels
