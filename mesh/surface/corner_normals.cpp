#include "lancet/mesh/surface/corner_normals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace lancet::mesh {

namespace {

/// Triangles that go through the arithmetic side by side. The compiler makes vectors of the loops over them: everything
/// is computed for all and then chosen. Conditions are not combined, and come from one comparison each, since those of
/// several would be turned into bytes and back. Several short loops, for what follows from each other in one is waited
/// for.
constexpr std::size_t lanes = 16;
using Lane = std::array<double, lanes>;
using Lanes3 = std::array<Lane, 3>;

struct Batch {
    std::array<Lanes3, 3> corners;  ///< [corner][axis]
    Lanes3 cross;                   ///< of two edges, [axis]
    Lane square;                    ///< of its length
    Lanes3 dots;                    ///< of the edges at each [corner]
    Lane middle_dot, largest_dot;
    Lane smallest, middle, largest;  ///< angles over the length
    std::array<Lanes3, 3> normals;   ///< [corner][axis]
    Lane is_extreme;                 ///< 1 or 0
};

/// Beyond these, squares may have lost digits, or everything. |n| is at most twice the largest product of edges.
constexpr double smallest_square = 1e-250, largest_product = 1e120;

// As std::min and std::max, by value: these become single instructions.
inline double smaller(double a, double b) {
    return b < a ? b : a;
}
inline double larger(double a, double b) {
    return a < b ? b : a;
}
inline double choose(bool condition, double yes, double no) {
    return condition ? yes : no;
}

/// The arctangent for |z| <= tan(pi / 8): the polynomial of this degree in z^2 whose largest relative error is
/// smallest, 3.5e-17 (by Remez' algorithm).
inline double arctangent(double z) {
    constexpr std::array coefficients{-0x1.5555555555318p-2, 0x1.9999999949772p-3,  -0x1.249249057e121p-3,
                                      0x1.c71c65cff492ap-4,  -0x1.745bc339b4223p-4, 0x1.3afc35f0ea4f9p-4,
                                      -0x1.1005343220b42p-4, 0x1.d255342a15ee3p-5,  -0x1.6518dfb04a5fdp-5,
                                      0x1.5c524aa8220a7p-6};
    const double square = z * z;
    const double fourth = square * square;
    double even = coefficients[8], odd = coefficients[9];
    even = coefficients[6] + fourth * even;
    odd = coefficients[7] + fourth * odd;
    even = coefficients[4] + fourth * even;
    odd = coefficients[5] + fourth * odd;
    even = coefficients[2] + fourth * even;
    odd = coefficients[3] + fourth * odd;
    even = coefficients[0] + fourth * even;
    odd = coefficients[1] + fourth * odd;
    const double sum = even + square * odd;
    return z + z * (square * sum);
}

/// The angle of (x, y) for y <= tan(3 pi / 8) x, turned back by 45 degrees where it is more than half of that.
inline double angle(double y, double x) {
    constexpr double tangent = 0x1.a827999fcef32p-2;  // of pi / 8
    const bool is_turned = y > x * tangent;
    const double across = y - choose(is_turned, x, 0), along = x + choose(is_turned, y, 0);
    return choose(is_turned, std::numbers::pi / 4, 0) + arctangent(across / along);
}

/// Whether the largest angle of a triangle is at its first corner, or the last. The longest edge is opposite to it.
inline bool is_largest_at_a(double dot_a, double dot_b, double dot_c) {
    return dot_a < smaller(dot_b, dot_c);
}
inline bool is_largest_at_c(double dot_a, double dot_b, double dot_c) {
    return dot_c < smaller(dot_a, dot_b);
}

/// The products of edges.
void multiply(Batch& batch) {
    const auto& [a, b, c] = batch.corners;
    for (std::size_t i = 0; i < lanes; ++i) {
        const double ab_x = b[0][i] - a[0][i], ab_y = b[1][i] - a[1][i], ab_z = b[2][i] - a[2][i];
        const double ac_x = c[0][i] - a[0][i], ac_y = c[1][i] - a[1][i], ac_z = c[2][i] - a[2][i];
        const double bc_x = c[0][i] - b[0][i], bc_y = c[1][i] - b[1][i], bc_z = c[2][i] - b[2][i];
        const double dot_a = ab_x * ac_x + ab_y * ac_y + ab_z * ac_z;
        const double dot_b = -(ab_x * bc_x + ab_y * bc_y + ab_z * bc_z);
        const double dot_c = ac_x * bc_x + ac_y * bc_y + ac_z * bc_z;
        // AB x AC = AB x BC = AC x BC.
        const bool is_at_c = is_largest_at_c(dot_a, dot_b, dot_c), is_at_a = is_largest_at_a(dot_a, dot_b, dot_c);
        const double u_x = choose(is_at_c, ac_x, ab_x), u_y = choose(is_at_c, ac_y, ab_y),
                     u_z = choose(is_at_c, ac_z, ab_z);
        const double v_x = choose(is_at_a, ac_x, bc_x), v_y = choose(is_at_a, ac_y, bc_y),
                     v_z = choose(is_at_a, ac_z, bc_z);
        const double x = u_y * v_z - u_z * v_y, y = u_z * v_x - u_x * v_z, z = u_x * v_y - u_y * v_x;
        batch.cross[0][i] = x, batch.cross[1][i] = y, batch.cross[2][i] = z;
        batch.square[i] = x * x + y * y + z * z;
        const double lower = smaller(dot_a, dot_b), upper = larger(dot_a, dot_b), inner = smaller(upper, dot_c);
        batch.middle_dot[i] = larger(lower, inner);
        batch.largest_dot[i] = larger(upper, dot_c);
        batch.dots[0][i] = dot_a, batch.dots[1][i] = dot_b, batch.dots[2][i] = dot_c;
    }
}

/// The angles. |n| is the same at all corners: the larger the product of the edges, the smaller the angle.
void find_angles(Batch& batch) {
    for (std::size_t i = 0; i < lanes; ++i) {
        const double square = batch.square[i], middle_dot = batch.middle_dot[i], largest_dot = batch.largest_dot[i];
        const double length = std::sqrt(square);
        const double below_diagonal = angle(smaller(length, middle_dot), larger(length, middle_dot));
        const double middle_angle = choose(middle_dot < length, std::numbers::pi / 2 - below_diagonal, below_diagonal);
        const double smallest_angle = angle(length, largest_dot);
        const double largest_angle = std::numbers::pi - smallest_angle - middle_angle;
        const double scale = 1 / length;
        batch.smallest[i] = smallest_angle * scale;
        batch.middle[i] = middle_angle * scale;
        batch.largest[i] = largest_angle * scale;
        batch.is_extreme[i] = choose(square > smallest_square, choose(largest_dot < largest_product, 0, 1), 1);
    }
}

/// What each corner gets.
void weigh(Batch& batch) {
    auto& [at_a, at_b, at_c] = batch.normals;
    for (std::size_t i = 0; i < lanes; ++i) {
        const double dot_a = batch.dots[0][i], dot_b = batch.dots[1][i], dot_c = batch.dots[2][i];
        const double lower = smaller(dot_a, dot_b), least_dot = smaller(lower, dot_c);
        const double largest_dot = larger(larger(dot_a, dot_b), dot_c);
        const double smallest = batch.smallest[i], middle = batch.middle[i], largest = batch.largest[i];
        const double of_a =
            choose(is_largest_at_a(dot_a, dot_b, dot_c), largest, choose(dot_a == largest_dot, smallest, middle));
        const double of_b = choose(dot_b == least_dot, largest, choose(dot_b == largest_dot, smallest, middle));
        const double of_c =
            choose(is_largest_at_c(dot_a, dot_b, dot_c), largest, choose(dot_c == largest_dot, smallest, middle));
        const double x = batch.cross[0][i], y = batch.cross[1][i], z = batch.cross[2][i];
        at_a[0][i] = of_a * x, at_a[1][i] = of_a * y, at_a[2][i] = of_a * z;
        at_b[0][i] = of_b * x, at_b[1][i] = of_b * y, at_b[2][i] = of_b * z;
        at_c[0][i] = of_c * x, at_c[1][i] = of_c * y, at_c[2][i] = of_c * z;
    }
}

/// The direction from a to b; zero where there is none.
Point direction(const Point& a, const Point& b) {
    const Point d{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const double length = std::hypot(d[0], d[1], d[2]);
    if (!(length > 0) || !std::isfinite(length)) return {};
    return {d[0] / length, d[1] / length, d[2] / length};
}

/// The same for one corner p of a triangle of any size, with edges of unit length.
Point extreme_corner_normal(const Point& p, const Point& q, const Point& r) {
    const Point u = direction(p, q), v = direction(p, r);
    const Point n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const double sine = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(sine > 0)) return {};
    const double weight = std::atan2(sine, u[0] * v[0] + u[1] * v[1] + u[2] * v[2]) / sine;
    return {weight * n[0], weight * n[1], weight * n[2]};
}

}  // namespace

void corner_normals(std::span<const Triangle> triangles, std::span<const Point> positions, std::span<Point> normals) {
    Batch batch;
    for (std::size_t begin = 0; begin < triangles.size(); begin += lanes) {
        const std::size_t count = std::min(lanes, triangles.size() - begin);
        const auto corner = [&](std::size_t lane, std::size_t k) -> const Point& {
            return positions[static_cast<std::size_t>(triangles[begin + lane][k % 3])];
        };
        for (std::size_t i = 0; i < lanes; ++i) {
            // The last triangle fills up the batch.
            const std::size_t lane = std::min(i, count - 1);
            for (std::size_t k = 0; k < 3; ++k) {
                const Point& place = corner(lane, k);
                for (std::size_t axis = 0; axis < 3; ++axis) batch.corners[k][axis][i] = place[axis];
            }
        }
        multiply(batch);
        find_angles(batch);
        weigh(batch);
        double extremes = 0;
        for (const double is_extreme : batch.is_extreme) extremes += is_extreme;
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                normals[3 * (begin + i) + k] = {batch.normals[k][0][i], batch.normals[k][1][i], batch.normals[k][2][i]};
            }
        }
        if (extremes == 0) continue;
        for (std::size_t i = 0; i < count; ++i) {
            if (batch.is_extreme[i] == 0) continue;
            for (std::size_t k = 0; k < 3; ++k) {
                normals[3 * (begin + i) + k] = extreme_corner_normal(corner(i, k), corner(i, k + 1), corner(i, k + 2));
            }
        }
    }
}

}  // namespace lancet::mesh
