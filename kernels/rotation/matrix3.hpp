#pragma once

#include "lancet/kernels/simd/pack.hpp"

namespace lancet::kernels {

/// A 3 x 3 matrix in every lane: entry[row][column].
template <class P>
struct Matrix3 {
    P entry[3][3];
};

/// a - b.
template <class P>
LANCET_INLINE Matrix3<P> subtract(const Matrix3<P>& a, const Matrix3<P>& b) {
    Matrix3<P> difference;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) difference.entry[i][j] = a.entry[i][j] - b.entry[i][j];
    }
    return difference;
}

/// Reads the nine row-major entries of a batch, [entry][lane].
template <class P>
LANCET_INLINE Matrix3<P> load_matrix(const typename P::Real* source) {
    Matrix3<P> a;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            a.entry[row][column] = P::load(source + (3 * row + column) * P::width);
        }
    }
    return a;
}

/// The matrix times a number.
template <class P>
LANCET_INLINE Matrix3<P> scale(const Matrix3<P>& a, P factor) {
    Matrix3<P> b;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) b.entry[row][column] = a.entry[row][column] * factor;
    }
    return b;
}

/// a b.
template <class P>
LANCET_INLINE Matrix3<P> multiply(const Matrix3<P>& a, const Matrix3<P>& b) {
    Matrix3<P> c;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            c.entry[row][column] = fma(a.entry[row][2], b.entry[2][column],
                                       fma(a.entry[row][1], b.entry[1][column], a.entry[row][0] * b.entry[0][column]));
        }
    }
    return c;
}

/// a^T b.
template <class P>
LANCET_INLINE Matrix3<P> multiply_transposed(const Matrix3<P>& a, const Matrix3<P>& b) {
    Matrix3<P> c;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            c.entry[row][column] = fma(a.entry[2][row], b.entry[2][column],
                                       fma(a.entry[1][row], b.entry[1][column], a.entry[0][row] * b.entry[0][column]));
        }
    }
    return c;
}

/// The sum of the absolute entries.
template <class P>
LANCET_INLINE P absolute_sum(const Matrix3<P>& a) {
    const P first = abs(a.entry[0][0]) + abs(a.entry[0][1]) + abs(a.entry[0][2]);
    const P second = abs(a.entry[1][0]) + abs(a.entry[1][1]) + abs(a.entry[1][2]);
    const P third = abs(a.entry[2][0]) + abs(a.entry[2][1]) + abs(a.entry[2][2]);
    return first + second + third;
}

/// The largest absolute entry.
template <class P>
LANCET_INLINE P largest_entry(const Matrix3<P>& a) {
    P largest(typename P::Real(0));
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) largest = max(abs(a.entry[row][column]), largest);
    }
    return largest;
}

}  // namespace lancet::kernels
