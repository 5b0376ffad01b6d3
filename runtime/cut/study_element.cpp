#include "lancet/runtime/cut/study_element.hpp"

#include <cmath>
#include <cstddef>
#include <string>

#include "lancet/kernels/error.hpp"
#include "lancet/kernels/layout/element_batches.hpp"
#include "lancet/runtime/simulate/scene.hpp"

namespace lancet::runtime {

namespace {

void require_fraction(double fraction, const char* what) {
    if (fraction > 0 && fraction < 1) return;
    throw Error(std::string(what) + " is " + std::to_string(fraction) + "; expected a number between 0 and 1");
}

/// The part [begin, end] of a bar: with m the middle and l the length, int phi = l m and int phi^2 = l (m^2 + l^2 /
/// 12).
StudyPart part_of_bar(double begin, double end) {
    const double length = end - begin;
    const std::array<double, 2> middle{1 - (begin + end) / 2, (begin + end) / 2};
    StudyPart part{.fraction = length, .first = {length * middle[0], length * middle[1]}, .second = {}};
    const double spread = length * length / 12;
    for (std::size_t i = 0; i < 2; ++i) {
        for (std::size_t j = 0; j < 2; ++j) {
            part.second.push_back(length * (middle[i] * middle[j] + (i == j ? spread : -spread)));
        }
    }
    return part;
}

/// The point of edge a b with coordinates of_a and of_b.
mesh::Barycentric on_edge(std::size_t a, double of_a, std::size_t b, double of_b) {
    mesh::Barycentric point{};
    point[a] = of_a;
    point[b] = of_b;
    return point;
}

mesh::Barycentric corner(std::size_t node) {
    return on_edge(node, 1, node, 1);
}

/// The prism between triangles a and b, whose corners are joined pairwise.
mesh::PartMoments prism(const std::array<mesh::Barycentric, 3>& a, const std::array<mesh::Barycentric, 3>& b) {
    mesh::PartMoments moments = mesh::empty_moments();
    mesh::add_tetrahedron(moments, {a[0], a[1], a[2], b[2]});
    mesh::add_tetrahedron(moments, {a[0], a[1], b[1], b[2]});
    mesh::add_tetrahedron(moments, {a[0], b[0], b[1], b[2]});
    return moments;
}

/// The wedge at edge a b whose other edges, to c and d, are cut at near from a and b; far = 1 - near.
mesh::PartMoments wedge(std::size_t a, std::size_t b, std::size_t c, std::size_t d, double near, double far) {
    return prism({corner(a), on_edge(a, far, c, near), on_edge(a, far, d, near)},
                 {corner(b), on_edge(b, far, c, near), on_edge(b, far, d, near)});
}

/// The root s in (0, 1/2] of 3 s^2 - 2 s^3 = fraction <= 1/2: the fraction of a tetrahedron where lambda_2 + lambda_3 <
/// s. Newton's iteration falls to it from sqrt(fraction / 2), for the cubic is convex up to 1/2 and at least 2 s^2
/// there.
double wedge_width(double fraction) {
    double s = std::sqrt(fraction / 2);
    for (int iteration = 0; iteration < 60; ++iteration) {
        const double next = s - (s * s * (3 - 2 * s) - fraction) / (6 * s * (1 - s));
        if (!(next < s)) break;
        s = next;
    }
    return s;
}

}  // namespace

StudyElement study_bar() {
    return {.corners = 2, .axes = 1, .stiffness = {1, -1, -1, 1}};
}

StudyElement study_tetrahedron(const std::array<mesh::Point, 4>& corners, double poisson_ratio) {
    const auto [lambda, mu, density] = elastic_parameters({.young_modulus = 1, .poisson_ratio = poisson_ratio});
    const auto [gradients, volume] = kernels::tetrahedron_geometry(corners, {0, 1, 2, 3});
    if (!(std::abs(volume) > 0)) throw Error("study of critical steps: the tetrahedron has no volume");
    StudyElement element{.corners = 4, .axes = 3, .stiffness = {}};
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t row = 0; row < 3; ++row) {
            for (std::size_t j = 0; j < 4; ++j) {
                double product = 0;
                for (std::size_t axis = 0; axis < 3; ++axis) product += gradients[i][axis] * gradients[j][axis];
                for (std::size_t column = 0; column < 3; ++column) {
                    element.stiffness.push_back(std::abs(volume) * (lambda * gradients[i][row] * gradients[j][column] +
                                                                    mu * gradients[j][row] * gradients[i][column] +
                                                                    (row == column ? mu * product : 0.0)));
                }
            }
        }
    }
    return element;
}

StudyPart study_part(const mesh::PartMoments& moments) {
    StudyPart part{.fraction = moments.fraction, .first = {moments.first.begin(), moments.first.end()}, .second = {}};
    for (const auto& row : moments.second) part.second.insert(part.second.end(), row.begin(), row.end());
    return part;
}

std::array<StudyPart, 2> cut_bar(double cut) {
    require_fraction(cut, "the place of the cut of a bar");
    return {part_of_bar(0, cut), part_of_bar(cut, 1)};
}

std::array<mesh::PartMoments, 2> cut_off_corner(double fraction) {
    require_fraction(fraction, "the fraction of a cut tetrahedron");
    const double near = std::cbrt(fraction);
    // 1 - near without the cancellation.
    const double far = -std::expm1(std::log(fraction) / 3);
    std::array<mesh::Barycentric, 3> cuts{};
    for (std::size_t k = 0; k < 3; ++k) cuts[k] = on_edge(0, far, k + 1, near);
    mesh::PartMoments tip = mesh::empty_moments();
    mesh::add_tetrahedron(tip, {corner(0), cuts[0], cuts[1], cuts[2]});
    return {tip, prism({corner(1), corner(2), corner(3)}, cuts)};
}

std::array<mesh::PartMoments, 2> cut_off_edge(double fraction) {
    require_fraction(fraction, "the fraction of a cut tetrahedron");
    const bool is_smaller = fraction <= 0.5;
    const double width = wedge_width(is_smaller ? fraction : 1 - fraction);
    const double near = is_smaller ? width : 1 - width;
    const double far = is_smaller ? 1 - width : width;
    return {wedge(0, 1, 2, 3, near, far), wedge(2, 3, 0, 1, far, near)};
}

}  // namespace lancet::runtime
