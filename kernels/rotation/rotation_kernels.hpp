#pragma once

#include <string_view>

namespace lancet::kernels {

/// How the rotation nearest to a deformation gradient is found: the proper rotation R that maximises tr(R^T F).
enum class RotationMethod {
    quaternion,  ///< Newton steps on a unit quaternion from a warm start (Kugelstadt, Koschier, Bender 2018): fastest,
                 ///< but only as good as its start, and wrong after a jump of the rotation by more than 90 degrees
    polar,       ///< the dominant eigenvector of Horn's 4 x 4 matrix, svd where it is not single; no start needed
    svd,         ///< singular value decomposition with the inversion convention (McAdams et al. 2011): the reference
    robust       ///< quaternion with a test of convergence, and svd in the lanes that fail it: the default
};

/// The name that options and tables use.
constexpr std::string_view to_string(RotationMethod method) {
    switch (method) {
        case RotationMethod::quaternion:
            return "quaternion";
        case RotationMethod::polar:
            return "polar";
        case RotationMethod::svd:
            return "svd";
        case RotationMethod::robust:
            return "robust";
    }
    return "unknown";
}

/// The rotation kernels of one instruction set.
template <class Real>
struct RotationKernels {
    /// Finds the rotation nearest to F, lane by lane, for the batches [begin, end). A proper rotation (finite,
    /// orthogonal, det +1) results for every finite F.
    /// - deformation_gradient: [batch][row-major 3 x 3 entry][lane]
    /// - quaternion: [batch][w, x, y, z][lane], unit; the start on entry (quaternion and robust read it), the rotation
    ///   on exit
    /// - steps: Newton steps of method quaternion, and of method robust before its first test; the others ignore it
    void (*decompose)(RotationMethod method, int steps, const Real* deformation_gradient, Real* quaternion, int begin,
                      int end);
};

}  // namespace lancet::kernels
