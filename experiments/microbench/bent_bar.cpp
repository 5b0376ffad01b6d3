#include "lancet/experiments/microbench/bent_bar.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <utility>

#include "lancet/kernels/layout/element_batches.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/mesh/order.hpp"

namespace lancet::experiments {

namespace {

constexpr std::array<double, 3> size{4.0, 0.8, 0.8};  // m

/// How far the bar is bent and twisted at its end, in radians.
struct Shape {
    double bend;
    double twist;
};

/// The free end of the Bar falls by about 0.16 m in a step of its fastest time: 0.06 rad.
constexpr std::array<Shape, 2> shapes{{{1.0, 0.3}, {1.06, 0.32}}};

mesh::Point deformed(const mesh::Point& rest, const Shape& shape) {
    // A ripple gives the elements strains and rotations of their own.
    constexpr double amplitude = 0.005, wavelength = 0.5;  // m
    const double along = rest[0] / size[0];
    const double ripple = amplitude * along;
    const auto wave = [](double at) { return std::sin(2 * std::numbers::pi * at / wavelength); };
    const double y = rest[1] - size[1] / 2 + ripple * wave(rest[0] + rest[2]);
    const double z = rest[2] - size[2] / 2 + ripple * wave(rest[0] + 2 * rest[1]);
    const double twist = shape.twist * along;
    const double across = std::cos(twist) * y - std::sin(twist) * z;
    const double aside = std::sin(twist) * y + std::cos(twist) * z;
    const double bend = shape.bend * along;
    const double radius = size[0] / shape.bend;
    return {radius * std::sin(bend) + across * std::sin(bend),
            size[1] / 2 - radius * (1 - std::cos(bend)) + across * std::cos(bend), size[2] / 2 + aside};
}

kernels::NodeNumbering number(const mesh::TetMesh& mesh) {
    std::vector<std::uint8_t> fixed(mesh.nodes().size(), 0);
    for (const std::int32_t node : mesh.node_set("x_min")) fixed[static_cast<std::size_t>(node)] = 1;
    const mesh::Ordering ordering = mesh::order(mesh, mesh::OrderingKind::hilbert);
    return kernels::number_nodes(mesh.nodes(), mesh.tetrahedra(), fixed, ordering.new_of_node);
}

/// Unused nodes stand where the first node stands, as in a body.
template <class Position>
kernels::AlignedVector<double> place(const BentBar& bar, const Position& position) {
    kernels::AlignedVector<double> all;
    all.reserve(4 * bar.numbering.user_of_internal.size());
    for (const std::int32_t user : bar.numbering.user_of_internal) {
        const mesh::Point point = position(bar.mesh.nodes()[static_cast<std::size_t>(std::max(user, 0))]);
        all.insert(all.end(), {point[0], point[1], point[2], 0.0});
    }
    return all;
}

}  // namespace

BentBar make_bent_bar(const std::array<int, 3>& cells) {
    mesh::Box box;
    box.cells = cells;
    box.size = size;
    BentBar bar;
    bar.mesh = mesh::box(box);
    bar.numbering = number(bar.mesh);

    const auto nodes = static_cast<std::size_t>(bar.numbering.node_count);
    bar.nodal_mass.assign(nodes, 0.0);
    for (const mesh::Tetrahedron& element : bar.mesh.tetrahedra()) {
        const double quarter =
            BentBar::material.density * kernels::tetrahedron_geometry(bar.mesh.nodes(), element).volume / 4;
        for (const std::int32_t node : element) {
            bar.nodal_mass[static_cast<std::size_t>(bar.numbering.internal_of_user[static_cast<std::size_t>(node)])] +=
                quarter;
        }
    }

    bar.rest = place(bar, [](const mesh::Point& point) { return point; });
    for (std::size_t state = 0; state < shapes.size(); ++state) {
        bar.states[state] = place(bar, [&](const mesh::Point& point) { return deformed(point, shapes[state]); });
    }

    std::mt19937 generator(2007);
    std::normal_distribution<float> normal;
    for (auto& vector : bar.random) {
        vector.assign(4 * nodes, 0.0);
        for (const std::int32_t internal : bar.numbering.internal_of_user) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double value = normal(generator);
                if (bar.numbering.is_free(internal)) vector[4 * static_cast<std::size_t>(internal) + axis] = value;
            }
        }
    }
    return bar;
}

}  // namespace lancet::experiments
