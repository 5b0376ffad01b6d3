#include "lancet/mesh/cut/part_moments.hpp"

#include <cmath>
#include <cstddef>

namespace lancet::mesh {

namespace {

/// Volume of a tetrahedron over that of the one whose barycentric coordinates c_k are given: |det c|.
///
/// The coordinates of a point add up to one, so a column of c may be replaced by ones; with the row of a base point b
/// subtracted, det c = +-det (c_k,i - c_b,i) over the three other points k and the three other columns i. The base and
/// the column left out are those of the largest coordinate: the other coordinates of the base are then small, zero in a
/// corner, and the differences of small numbers keep their relative precision.
double volume_fraction(const std::array<Barycentric, 4>& c) {
    std::size_t base = 0, left_out = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        for (std::size_t i = 0; i < 4; ++i) {
            if (c[k][i] > c[base][left_out]) base = k, left_out = i;
        }
    }
    std::array<std::array<double, 3>, 3> d{};
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 3; ++column) {
            const std::size_t i = (left_out + 1 + column) % 4;
            d[row][column] = c[(base + 1 + row) % 4][i] - c[base][i];
        }
    }
    return std::abs(d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) +
                    d[0][1] * (d[1][2] * d[2][0] - d[1][0] * d[2][2]) +
                    d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]));
}

}  // namespace

PartMoments empty_moments() {
    return {.fraction = 0, .first = {}, .second = {}};
}

void add_weighted(PartMoments& moments, const PartMoments& other, double weight) {
    moments.fraction += weight * other.fraction;
    for (std::size_t i = 0; i < 4; ++i) {
        moments.first[i] += weight * other.first[i];
        for (std::size_t j = 0; j < 4; ++j) moments.second[i][j] += weight * other.second[i][j];
    }
}

void add_tetrahedron(PartMoments& moments, const std::array<Barycentric, 4>& corners) {
    add_tetrahedron(moments, corners, volume_fraction(corners));
}

void add_tetrahedron(PartMoments& moments, const std::array<Barycentric, 4>& corners, double fraction) {
    // Over a tetrahedron of volume v, a linear function f with values f_k at the corners has int f = v/4 sum_k f_k, and
    // int f g = v/20 (sum_k f_k g_k + sum_k f_k sum_l g_l).
    Barycentric sum{};
    for (const Barycentric& corner : corners) {
        for (std::size_t i = 0; i < 4; ++i) sum[i] += corner[i];
    }
    moments.fraction += fraction;
    for (std::size_t i = 0; i < 4; ++i) {
        moments.first[i] += fraction / 4 * sum[i];
        for (std::size_t j = 0; j < 4; ++j) {
            double products = sum[i] * sum[j];
            for (const Barycentric& corner : corners) products += corner[i] * corner[j];
            moments.second[i][j] += fraction / 20 * products;
        }
    }
}

}  // namespace lancet::mesh
