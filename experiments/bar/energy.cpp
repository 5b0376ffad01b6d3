#include "lancet/experiments/bar/energy.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::bar {
namespace {

using Vector = std::array<double, 3>;
using Matrix = std::array<Vector, 3>;  // rows

double determinant(const Matrix& a) {
    return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
           a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}

/// Columns are the edges from the first node to the others.
Matrix edges(const mesh::Tetrahedron& nodes, const auto& point) {
    Matrix result{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t edge = 0; edge < 3; ++edge) {
            result[axis][edge] = point(nodes[edge + 1], axis) - point(nodes[0], axis);
        }
    }
    return result;
}

Matrix inverse(const Matrix& a) {
    const double scale = 1 / determinant(a);
    Matrix result{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            const std::size_t p = (j + 1) % 3;
            const std::size_t q = (j + 2) % 3;
            const std::size_t r = (i + 1) % 3;
            const std::size_t s = (i + 2) % 3;
            result[i][j] = scale * (a[p][r] * a[q][s] - a[p][s] * a[q][r]);
        }
    }
    return result;
}

Matrix product(const Matrix& a, const Matrix& b) {
    Matrix result{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            result[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
        }
    }
    return result;
}

/// Eigenvalues of a symmetric matrix, descending, by the trigonometric formula.
Vector symmetric_eigenvalues(const Matrix& a) {
    const double mean = (a[0][0] + a[1][1] + a[2][2]) / 3;
    const double off_diagonal = a[0][1] * a[0][1] + a[0][2] * a[0][2] + a[1][2] * a[1][2];
    double deviation = 2 * off_diagonal;
    for (std::size_t i = 0; i < 3; ++i) deviation += (a[i][i] - mean) * (a[i][i] - mean);
    const double radius = std::sqrt(deviation / 6);
    if (radius == 0) return {mean, mean, mean};
    Matrix shifted = a;
    for (std::size_t i = 0; i < 3; ++i) {
        shifted[i][i] -= mean;
        for (double& entry : shifted[i]) entry /= radius;
    }
    const double angle = std::acos(std::clamp(determinant(shifted) / 2, -1.0, 1.0)) / 3;
    const double first = mean + 2 * radius * std::cos(angle);
    const double last = mean + 2 * radius * std::cos(angle + 2 * std::numbers::pi / 3);
    return {first, 3 * mean - first - last, last};
}

/// Singular values minus one; the smallest singular value carries the sign of det F.
Vector principal_stretches_minus_one(const Matrix& gradient) {
    Matrix displacement_gradient = gradient;
    for (std::size_t i = 0; i < 3; ++i) displacement_gradient[i][i] -= 1;
    const auto& h = displacement_gradient;
    Matrix strain{};  // F^T F - 1, without cancellation
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            strain[i][j] = h[i][j] + h[j][i] + h[0][i] * h[0][j] + h[1][i] * h[1][j] + h[2][i] * h[2][j];
        }
    }
    Vector stretches = symmetric_eigenvalues(strain);
    for (double& value : stretches) value = value / (1 + std::sqrt(std::max(0.0, 1 + value)));
    if (determinant(gradient) < 0) stretches[2] = -2 - stretches[2];
    return stretches;
}

double energy_density(const Problem& problem, const Matrix& gradient) {
    const double shear = problem.young_modulus / (2 * (1 + problem.poisson_ratio));
    const double lame =
        problem.young_modulus * problem.poisson_ratio / ((1 + problem.poisson_ratio) * (1 - 2 * problem.poisson_ratio));
    const Vector s = principal_stretches_minus_one(gradient);
    const double trace = s[0] + s[1] + s[2];
    return shear * (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]) + lame / 2 * trace * trace;
}

}  // namespace

std::vector<double> lumped_masses(const Problem& problem) {
    std::vector<double> masses(problem.mesh.nodes().size(), 0.0);
    const auto tetrahedra = problem.mesh.tetrahedra();
    for (std::size_t element = 0; element < tetrahedra.size(); ++element) {
        const double quarter = problem.density * problem.mesh.volume(static_cast<std::int32_t>(element)) / 4;
        for (const std::int32_t node : tetrahedra[element]) masses[static_cast<std::size_t>(node)] += quarter;
    }
    return masses;
}

Energy energy(const Problem& problem, std::span<const double> positions, std::span<const double> velocities) {
    const auto nodes = problem.mesh.nodes();
    if (positions.size() != 3 * nodes.size() || velocities.size() != 3 * nodes.size()) {
        throw Error("energy: state of " + std::to_string(positions.size()) + " and " +
                    std::to_string(velocities.size()) + " numbers, expected " + std::to_string(3 * nodes.size()));
    }
    Energy result;
    const std::vector<double> masses = lumped_masses(problem);
    for (std::size_t node = 0; node < nodes.size(); ++node) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double velocity = velocities[3 * node + axis];
            result.kinetic += masses[node] * velocity * velocity / 2;
            result.gravitational -=
                masses[node] * problem.gravity[axis] * (positions[3 * node + axis] - nodes[node][axis]);
        }
    }
    const auto rest = [&](std::int32_t node, std::size_t axis) { return nodes[static_cast<std::size_t>(node)][axis]; };
    const auto now = [&](std::int32_t node, std::size_t axis) {
        return positions[3 * static_cast<std::size_t>(node) + axis];
    };
    const auto tetrahedra = problem.mesh.tetrahedra();
    for (std::size_t element = 0; element < tetrahedra.size(); ++element) {
        const Matrix gradient = product(edges(tetrahedra[element], now), inverse(edges(tetrahedra[element], rest)));
        result.elastic += problem.mesh.volume(static_cast<std::int32_t>(element)) * energy_density(problem, gradient);
    }
    return result;
}

}  // namespace lancet::experiments::bar
