#pragma once

#include "lancet/kernels/rotation/svd.hpp"
#include "lancet/kernels/rotation/symmetric_eigen.hpp"

namespace lancet::kernels {

/// The singular value decomposition F = U diag(s) V^T with proper U and V: where det F < 0 one stretch is negative.
/// The stretches have no particular order.
template <class P>
struct PrincipalStretches {
    P stretch[3];
    Matrix3<P> left;   ///< U
    Matrix3<P> right;  ///< V
};

/// The decomposition of F from the rotation nearest to it, R = U V^T: the eigenvectors of R^T F are V, its eigenvalues
/// the stretches, to the rounding of the largest one (those of F^T F would have lost half of the digits).
template <class P>
LANCET_INLINE PrincipalStretches<P> principal_stretches(const Matrix3<P>& f, const Matrix3<P>& rotation) {
    const SymmetricEigen<P> eigen = symmetric_eigen(symmetric_part_of_product(rotation, f));
    return {{eigen.value[0], eigen.value[1], eigen.value[2]}, multiply(rotation, eigen.vectors), eigen.vectors};
}

/// The decomposition of any finite F, without a start.
template <class P>
LANCET_INLINE PrincipalStretches<P> singular_value_decomposition(const Matrix3<P>& f) {
    return principal_stretches(f, to_matrix(svd_rotation(f)));
}

}  // namespace lancet::kernels
