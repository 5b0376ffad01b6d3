#pragma once

#include <array>
#include <span>
#include <vector>

#include "lancet/mesh/generate/box.hpp"

namespace lancet::experiments::precision {

using mesh::Point;

/// A continuous, piecewise linear vector field on the tetrahedra of a box, to be asked for at any point: how solutions
/// on different meshes are compared.
class BoxField {
  public:
    struct Value {
        Point value;
        std::array<Point, 3> gradient;  ///< [component][axis]
    };

    /// `values`: one for each node of mesh::box(box). Throws lancet::Error for another number of them.
    BoxField(const mesh::Box& box, std::span<const Point> values);

    /// The field at a point of the box at rest; points outside take the linear continuation of the nearest cell.
    [[nodiscard]] Value at(const Point& point) const;

    [[nodiscard]] const mesh::Box& box() const { return box_; }
    [[nodiscard]] std::span<const Point> values() const { return values_; }

  private:
    /// A tetrahedron of a cell of unit size: its corners, numbered x + 2 y + 4 z, and the gradients of its barycentric
    /// coordinates.
    struct Piece {
        std::array<int, 4> corners;
        std::array<Point, 4> gradients;
        [[nodiscard]] std::array<double, 4> coordinates(const Point& local) const;
    };

    mesh::Box box_;
    std::vector<Point> values_;
    std::array<std::vector<Piece>, 2> pieces_;  ///< of the cells of even and of odd i + j + k
};

}  // namespace lancet::experiments::precision
