#include "lancet/experiments/precision/box_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::precision {
namespace {

Point corner(int number) {
    return {static_cast<double>(number & 1), static_cast<double>((number >> 1) & 1), static_cast<double>(number >> 2)};
}

Point difference(const Point& a, const Point& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot(const Point& a, const Point& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Gradients of the barycentric coordinates of a tetrahedron.
std::array<Point, 4> barycentric_gradients(const std::array<int, 4>& corners) {
    std::array<Point, 3> edges{};
    for (std::size_t i = 0; i < 3; ++i) edges[i] = difference(corner(corners[i + 1]), corner(corners[0]));
    const double determinant = dot(edges[0], cross(edges[1], edges[2]));
    std::array<Point, 4> gradients{};
    for (std::size_t i = 0; i < 3; ++i) {
        const Point normal = cross(edges[(i + 1) % 3], edges[(i + 2) % 3]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            gradients[i + 1][axis] = normal[axis] / determinant;
            gradients[0][axis] -= normal[axis] / determinant;
        }
    }
    return gradients;
}

}  // namespace

std::array<double, 4> BoxField::Piece::coordinates(const Point& local) const {
    const Point offset = difference(local, corner(corners[0]));
    std::array<double, 4> result{1 + dot(gradients[0], offset), dot(gradients[1], offset), dot(gradients[2], offset),
                                 dot(gradients[3], offset)};
    return result;
}

BoxField::BoxField(const mesh::Box& box, std::span<const Point> values)
    : box_(box), values_(values.begin(), values.end()) {
    std::size_t nodes = 1;
    for (const int cells : box.cells) nodes *= static_cast<std::size_t>(cells) + 1;
    if (values.size() != nodes) {
        throw Error("field on a box: " + std::to_string(values.size()) + " values found, expected one for each of " +
                    std::to_string(nodes) + " nodes");
    }
    // How cells are cut is read off a mesh of an even and an odd one.
    const mesh::TetMesh two = mesh::box({.cells = {2, 1, 1},
                                         .size = {2, 1, 1},
                                         .split = box.split,
                                         .origin = {0, 0, 0},
                                         .swap_parity = box.swap_parity});
    const std::size_t in_cell = two.tetrahedra().size() / 2;
    for (std::size_t element = 0; element < two.tetrahedra().size(); ++element) {
        const std::size_t cell = element / in_cell;
        Piece piece{};
        for (std::size_t i = 0; i < 4; ++i) {
            const Point& at = two.nodes()[static_cast<std::size_t>(two.tetrahedra()[element][i])];
            piece.corners[i] = static_cast<int>(at[0]) - static_cast<int>(cell) + 2 * static_cast<int>(at[1]) +
                               4 * static_cast<int>(at[2]);
        }
        piece.gradients = barycentric_gradients(piece.corners);
        pieces_[cell].push_back(piece);
    }
}

BoxField::Value BoxField::at(const Point& point) const {
    std::array<int, 3> cell{};
    Point local{}, scale{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        scale[axis] = box_.cells[axis] / box_.size[axis];
        const double place = (point[axis] - box_.origin[axis]) * scale[axis];
        cell[axis] = std::clamp(static_cast<int>(std::floor(place)), 0, box_.cells[axis] - 1);
        local[axis] = place - cell[axis];
    }
    const std::vector<Piece>& pieces = pieces_[static_cast<std::size_t>((cell[0] + cell[1] + cell[2]) % 2)];
    const Piece* found = nullptr;
    std::array<double, 4> weights{};
    double deepest = 0;
    for (const Piece& piece : pieces) {
        const std::array<double, 4> coordinates = piece.coordinates(local);
        const double depth = *std::min_element(coordinates.begin(), coordinates.end());
        if (found != nullptr && depth <= deepest) continue;
        found = &piece;
        weights = coordinates;
        deepest = depth;
        if (depth >= 0) break;
    }
    Value result{};
    const int row = box_.cells[0] + 1;
    const int layer = row * (box_.cells[1] + 1);
    for (std::size_t i = 0; i < 4; ++i) {
        const int c = found->corners[i];
        const int node = cell[0] + (c & 1) + row * (cell[1] + ((c >> 1) & 1)) + layer * (cell[2] + (c >> 2));
        const Point& value = values_[static_cast<std::size_t>(node)];
        for (std::size_t component = 0; component < 3; ++component) {
            result.value[component] += weights[i] * value[component];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                result.gradient[component][axis] += value[component] * found->gradients[i][axis] * scale[axis];
            }
        }
    }
    return result;
}

}  // namespace lancet::experiments::precision
