#include "lancet/experiments/precision/norms.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "lancet/experiments/bar/corotational_element.hpp"
#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::experiments::precision {
namespace {

using Matrix = bar::Matrix3<double>;

/// The rotation of a deformation gradient 1 + `gradient`; 1 where an element is inverted.
Matrix rotation(const std::array<Point, 3>& gradient) {
    Matrix deformation{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) deformation.m[3 * i + j] = gradient[i][j] + (i == j ? 1.0 : 0.0);
    }
    Matrix result{{1, 0, 0, 0, 1, 0, 0, 0, 1}};
    bar::update_rotation(deformation, result);
    return result;
}

/// sigma : epsilon for the strain sym(m).
double energy_density(const Matrix& m, const EnergyForm& form) {
    const double shear = form.young_modulus / (2 * (1 + form.poisson_ratio));
    const double lame =
        form.young_modulus * form.poisson_ratio / ((1 + form.poisson_ratio) * (1 - 2 * form.poisson_ratio));
    double squares = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            const double strain = 0.5 * (m.m[3 * i + j] + m.m[3 * j + i]);
            squares += strain * strain;
        }
    }
    const double trace = m.m[0] + m.m[4] + m.m[8];
    return 2 * shear * squares + lame * trace * trace;
}

/// Integrates over the elements of `reference`: `value(point, reference value)` squared for the L2 norm,
/// `strain(centre, reference gradient)` for the energy norm.
template <class ValueAt, class StrainAt>
Norms integrate(const BoxField& reference, const EnergyForm& form, const ValueAt& value, const StrainAt& strain) {
    // Keast 1986, four points: exact to degree 2.
    constexpr double near = 0.58541019662496845446, far = 0.13819660112501051518;
    const mesh::TetMesh mesh = mesh::box(reference.box());
    double l2 = 0, energy = 0;
    for (std::size_t element = 0; element < mesh.tetrahedra().size(); ++element) {
        const mesh::Tetrahedron& nodes = mesh.tetrahedra()[element];
        const double volume = mesh.volume(static_cast<std::int32_t>(element));
        const auto mean = [&](std::span<const Point> values, const std::array<double, 4>& weights) {
            Point result{};
            for (std::size_t i = 0; i < 4; ++i) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    result[axis] += weights[i] * values[static_cast<std::size_t>(nodes[i])][axis];
                }
            }
            return result;
        };
        double squares = 0;
        for (std::size_t point = 0; point < 4; ++point) {
            std::array<double, 4> weights{far, far, far, far};
            weights[point] = near;
            const Point difference = value(mean(mesh.nodes(), weights), mean(reference.values(), weights));
            for (const double component : difference) squares += component * component / 4;
        }
        l2 += volume * squares;
        const Point centre = mean(mesh.nodes(), {0.25, 0.25, 0.25, 0.25});
        energy += volume * energy_density(strain(centre, reference.at(centre).gradient), form);
    }
    return {.l2 = std::sqrt(l2), .energy = std::sqrt(energy)};
}

}  // namespace

Norms error_norms(const BoxField& u, const BoxField& reference, const EnergyForm& form) {
    return integrate(
        reference, form,
        [&](const Point& point, const Point& exact) {
            Point difference = u.at(point).value;
            for (std::size_t axis = 0; axis < 3; ++axis) difference[axis] -= exact[axis];
            return difference;
        },
        [&](const Point& centre, const std::array<Point, 3>& exact) {
            const std::array<Point, 3> gradient = u.at(centre).gradient;
            Matrix difference{};
            for (std::size_t i = 0; i < 3; ++i) {
                for (std::size_t j = 0; j < 3; ++j) difference.m[3 * i + j] = gradient[i][j] - exact[i][j];
            }
            return form.rotated ? rotation(exact).transposed() * difference : difference;
        });
}

Norms norms(const BoxField& reference, const EnergyForm& form) {
    return integrate(
        reference, form, [](const Point&, const Point& exact) { return exact; },
        [&](const Point&, const std::array<Point, 3>& exact) {
            Matrix gradient{};
            for (std::size_t i = 0; i < 3; ++i) {
                for (std::size_t j = 0; j < 3; ++j) gradient.m[3 * i + j] = exact[i][j];
            }
            if (!form.rotated) return gradient;
            // R^T F - 1
            const Matrix back = rotation(exact).transposed();
            Matrix strain = back * gradient;
            for (std::size_t i = 0; i < 9; ++i) strain.m[i] += back.m[i] - (i % 4 == 0 ? 1.0 : 0.0);
            return strain;
        });
}

}  // namespace lancet::experiments::precision
