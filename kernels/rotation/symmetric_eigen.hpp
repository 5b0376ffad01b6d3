#pragma once

#include "lancet/kernels/rotation/constants.hpp"
#include "lancet/kernels/rotation/symmetric3.hpp"

namespace lancet::kernels {

/// A = V diag(value) V^T: the columns of V are the eigenvectors, det V = +1. The values have no particular order.
template <class P>
struct SymmetricEigen {
    P value[3];
    Matrix3<P> vectors;
};

/// A <- J^T A J, V <- V J for the plane turn J of axes p and q that makes A_pq vanish (Golub and Van Loan 2013,
/// Matrix Computations, section 8.5); r is the third axis.
template <class P>
LANCET_INLINE void diagonalise_pair(P& a_pp, P& a_qq, P& a_pq, P& a_pr, P& a_qr, Matrix3<P>& v, int p, int q) {
    using Real = typename P::Real;
    const P zero(Real(0)), one(Real(1)), two(Real(2));
    const P difference = a_qq - a_pp;
    const P twice = two * a_pq;
    const P denominator = abs(difference) + sqrt(fma(twice, twice, difference * difference));
    const auto nothing = denominator <= zero;
    const P size = twice / select(nothing, one, denominator);
    const P t = select(nothing, zero, select(difference < zero, -size, size));
    const P c = one / sqrt(fma(t, t, one));
    const P s = t * c;
    a_pp = fnma(t, a_pq, a_pp);
    a_qq = fma(t, a_pq, a_qq);
    a_pq = select(nothing, a_pq, zero);
    const P pr = fnma(s, a_qr, c * a_pr);
    const P qr = fma(s, a_pr, c * a_qr);
    a_pr = pr;
    a_qr = qr;
    for (int row = 0; row < 3; ++row) {
        const P x = v.entry[row][p];
        const P y = v.entry[row][q];
        v.entry[row][p] = fnma(s, y, c * x);
        v.entry[row][q] = fma(s, x, c * y);
    }
}

/// The eigenvalues and eigenvectors by cyclic Jacobi turns, to the rounding of the largest entry. A fixed number of
/// them, so that no lane depends on another one.
template <class P>
LANCET_INLINE SymmetricEigen<P> symmetric_eigen(const Symmetric3<P>& matrix) {
    using Real = typename P::Real;
    const P zero(Real(0)), one(Real(1));
    Symmetric3<P> a = matrix;
    SymmetricEigen<P> eigen;
    eigen.vectors = {{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}}};
    constexpr int sweeps = RotationConstants<P>::single ? 4 : 5;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        diagonalise_pair(a.xx, a.yy, a.xy, a.xz, a.yz, eigen.vectors, 0, 1);
        diagonalise_pair(a.yy, a.zz, a.yz, a.xy, a.xz, eigen.vectors, 1, 2);
        diagonalise_pair(a.zz, a.xx, a.xz, a.yz, a.xy, eigen.vectors, 2, 0);
    }
    eigen.value[0] = a.xx;
    eigen.value[1] = a.yy;
    eigen.value[2] = a.zz;
    return eigen;
}

}  // namespace lancet::kernels
