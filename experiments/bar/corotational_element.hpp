#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "lancet/experiments/bar/problem.hpp"

/// The corotational linear tetrahedron as textbooks have it, scalar and one structure per element: what both baselines
/// use. Deliberately apart from the library's kernels.
namespace lancet::experiments::bar {

template <class Scalar>
struct Vector3 {
    Scalar x, y, z;

    friend Vector3 operator+(const Vector3& a, const Vector3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vector3 operator-(const Vector3& a, const Vector3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vector3 operator*(Scalar s, const Vector3& a) { return {s * a.x, s * a.y, s * a.z}; }
    friend Scalar dot(const Vector3& a, const Vector3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
};

/// Rows first: entry (i, j) is m[3 * i + j].
template <class Scalar>
struct Matrix3 {
    std::array<Scalar, 9> m;

    friend Vector3<Scalar> operator*(const Matrix3& a, const Vector3<Scalar>& v) {
        return {a.m[0] * v.x + a.m[1] * v.y + a.m[2] * v.z, a.m[3] * v.x + a.m[4] * v.y + a.m[5] * v.z,
                a.m[6] * v.x + a.m[7] * v.y + a.m[8] * v.z};
    }
    /// a^T v
    friend Vector3<Scalar> transposed_product(const Matrix3& a, const Vector3<Scalar>& v) {
        return {a.m[0] * v.x + a.m[3] * v.y + a.m[6] * v.z, a.m[1] * v.x + a.m[4] * v.y + a.m[7] * v.z,
                a.m[2] * v.x + a.m[5] * v.y + a.m[8] * v.z};
    }
    friend Matrix3 operator*(const Matrix3& a, const Matrix3& b) {
        Matrix3 c;
        for (std::size_t i = 0; i < 9; i += 3) {
            for (std::size_t j = 0; j < 3; ++j) {
                c.m[i + j] = a.m[i] * b.m[j] + a.m[i + 1] * b.m[3 + j] + a.m[i + 2] * b.m[6 + j];
            }
        }
        return c;
    }
    friend Matrix3 operator*(Scalar s, const Matrix3& a) {
        Matrix3 c;
        for (std::size_t i = 0; i < 9; ++i) c.m[i] = s * a.m[i];
        return c;
    }
    [[nodiscard]] Matrix3 transposed() const { return {{m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]}}; }
    /// Cofactors: det(a) a^-T.
    [[nodiscard]] Matrix3 cofactors() const {
        return {{m[4] * m[8] - m[5] * m[7], m[5] * m[6] - m[3] * m[8], m[3] * m[7] - m[4] * m[6],
                 m[2] * m[7] - m[1] * m[8], m[0] * m[8] - m[2] * m[6], m[1] * m[6] - m[0] * m[7],
                 m[1] * m[5] - m[2] * m[4], m[2] * m[3] - m[0] * m[5], m[0] * m[4] - m[1] * m[3]}};
    }
};

/// Matrix with these columns.
template <class Scalar>
Matrix3<Scalar> from_columns(const Vector3<Scalar>& a, const Vector3<Scalar>& b, const Vector3<Scalar>& c) {
    return {{a.x, b.x, c.x, a.y, b.y, c.y, a.z, b.z, c.z}};
}

/// Replaces `rotation` by the orthogonal factor of the polar decomposition of `gradient`, with Newton's iteration
/// X <- (X + X^-T) / 2 (Higham 1986), to rounding. Where det `gradient` is not positive (flat or inverted element) the
/// iteration would fail or end in a reflection: `rotation` then stays as it is, and the result is false.
template <class Scalar>
bool update_rotation(const Matrix3<Scalar>& gradient, Matrix3<Scalar>& rotation) {
    constexpr Scalar epsilon = std::numeric_limits<Scalar>::epsilon();
    constexpr int most_iterations = 60;
    Matrix3<Scalar> x = gradient;
    for (int iteration = 0; iteration < most_iterations; ++iteration) {
        const Matrix3<Scalar> c = x.cofactors();
        const Scalar determinant = x.m[0] * c.m[0] + x.m[1] * c.m[1] + x.m[2] * c.m[2];
        if (!(determinant > std::numeric_limits<Scalar>::min())) return false;
        const Scalar scale = Scalar(0.5) / determinant;
        Scalar change = 0;
        for (std::size_t i = 0; i < 9; ++i) {
            const Scalar next = Scalar(0.5) * x.m[i] + scale * c.m[i];
            change += (next - x.m[i]) * (next - x.m[i]);
            x.m[i] = next;
        }
        if (change < 4 * epsilon) {  // the error is squared in every iteration
            rotation = x;
            return true;
        }
    }
    return false;
}

/// Node-pair blocks of an element, (i, j) at [4 * i + j].
template <class Scalar>
using ElementBlocks = std::array<Matrix3<Scalar>, 16>;

/// One corotational linear tetrahedron. Its stiffness blocks (i, j) are stored for i <= j of the nodes 1, 2, 3 only:
/// the others follow from symmetry and because rows add up to zero.
template <class Scalar>
struct CorotationalElement {
    std::array<std::int32_t, 4> nodes;
    Matrix3<Scalar> rest_inverse;               ///< of the matrix of rest edges
    std::array<Vector3<Scalar>, 3> rest_edges;  ///< from node 0 to nodes 1, 2, 3
    std::array<Matrix3<Scalar>, 6> stiffness;   ///< 11, 12, 13, 22, 23, 33
    Matrix3<Scalar> rotation;

    /// Rotation of the current positions.
    template <class Positions>
    void rotate(const Positions& x) {
        const Vector3<Scalar> origin = x[nodes[0]];
        const Matrix3<Scalar> edges = from_columns(x[nodes[1]] - origin, x[nodes[2]] - origin, x[nodes[3]] - origin);
        update_rotation(edges * rest_inverse, rotation);
    }

    /// Elastic forces on the four nodes, f = -R K (R^T x - X), with the rotation of the last rotate(). Edges are taken
    /// instead of positions, which changes nothing but the rounding: K does not see translations.
    template <class Positions>
    [[nodiscard]] std::array<Vector3<Scalar>, 4> forces(const Positions& x) const {
        const Vector3<Scalar> origin = x[nodes[0]];
        std::array<Vector3<Scalar>, 3> d;
        for (std::size_t j = 0; j < 3; ++j) {
            d[j] = transposed_product(rotation, x[nodes[j + 1]] - origin) - rest_edges[j];
        }
        const auto& k = stiffness;
        const Vector3<Scalar> f1 = rotation * (k[0] * d[0] + k[1] * d[1] + k[2] * d[2]);
        const Vector3<Scalar> f2 = rotation * (transposed_product(k[1], d[0]) + k[3] * d[1] + k[4] * d[2]);
        const Vector3<Scalar> f3 =
            rotation * (transposed_product(k[2], d[0]) + transposed_product(k[4], d[1]) + k[5] * d[2]);
        return {f1 + f2 + f3, Scalar(-1) * f1, Scalar(-1) * f2, Scalar(-1) * f3};
    }

    /// scale R K R^T as blocks of node pairs.
    [[nodiscard]] ElementBlocks<Scalar> rotated_stiffness(Scalar scale) const {
        ElementBlocks<Scalar> blocks;
        const Matrix3<Scalar> scaled = scale * rotation;
        const Matrix3<Scalar> back = rotation.transposed();
        std::size_t stored = 0;
        for (std::size_t i = 1; i < 4; ++i) {
            for (std::size_t j = i; j < 4; ++j) {
                blocks[4 * i + j] = scaled * stiffness[stored++] * back;
                if (i != j) blocks[4 * j + i] = blocks[4 * i + j].transposed();
            }
        }
        for (std::size_t entry = 0; entry < 9; ++entry) blocks[0].m[entry] = 0;
        for (std::size_t j = 1; j < 4; ++j) {
            for (std::size_t entry = 0; entry < 9; ++entry) {
                const Scalar sum = blocks[4 + j].m[entry] + blocks[8 + j].m[entry] + blocks[12 + j].m[entry];
                blocks[j].m[entry] = -sum;
                blocks[0].m[entry] += sum;
            }
            blocks[4 * j] = blocks[j].transposed();
        }
        return blocks;
    }
};

/// The element of four nodes at rest in an isotropic material: K_ij = V (lambda b_i b_j^T + mu b_j b_i^T + mu b_i.b_j
/// 1) with b_i the gradients of the shape functions. Computed in double, whatever Scalar is.
template <class Scalar>
CorotationalElement<Scalar> make_element(const Problem& problem, const mesh::Tetrahedron& nodes) {
    const double mu = problem.young_modulus / (2 * (1 + problem.poisson_ratio));
    const double lambda =
        problem.young_modulus * problem.poisson_ratio / ((1 + problem.poisson_ratio) * (1 - 2 * problem.poisson_ratio));
    std::array<Vector3<double>, 3> edges;
    const auto point = [&problem](std::int32_t node) {
        const mesh::Point& p = problem.mesh.nodes()[static_cast<std::size_t>(node)];
        return Vector3<double>{p[0], p[1], p[2]};
    };
    for (std::size_t j = 0; j < 3; ++j) edges[j] = point(nodes[j + 1]) - point(nodes[0]);
    const Matrix3<double> rest = from_columns(edges[0], edges[1], edges[2]);
    const Matrix3<double> cofactors = rest.cofactors();
    const double determinant = dot(edges[0], Vector3<double>{cofactors.m[0], cofactors.m[3], cofactors.m[6]});
    const Matrix3<double> inverse = (1 / determinant) * cofactors.transposed();
    const double volume = determinant / 6;

    CorotationalElement<Scalar> element;
    element.nodes = nodes;
    const auto convert = [](const Matrix3<double>& a) {
        Matrix3<Scalar> b;
        for (std::size_t i = 0; i < 9; ++i) b.m[i] = static_cast<Scalar>(a.m[i]);
        return b;
    };
    element.rest_inverse = convert(inverse);
    element.rotation = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};
    for (std::size_t j = 0; j < 3; ++j) {
        element.rest_edges[j] = {static_cast<Scalar>(edges[j].x), static_cast<Scalar>(edges[j].y),
                                 static_cast<Scalar>(edges[j].z)};
    }
    std::size_t stored = 0;
    for (std::size_t i = 0; i < 3; ++i) {  // row i of the inverse is the gradient of shape function i + 1
        for (std::size_t j = i; j < 3; ++j) {
            const double* bi = &inverse.m[3 * i];
            const double* bj = &inverse.m[3 * j];
            const double both = bi[0] * bj[0] + bi[1] * bj[1] + bi[2] * bj[2];
            Matrix3<double> block;
            for (std::size_t r = 0; r < 3; ++r) {
                for (std::size_t c = 0; c < 3; ++c) {
                    block.m[3 * r + c] =
                        volume * (lambda * bi[r] * bj[c] + mu * bj[r] * bi[c] + (r == c ? mu * both : 0.0));
                }
            }
            element.stiffness[stored++] = convert(block);
        }
    }
    return element;
}

}  // namespace lancet::experiments::bar
