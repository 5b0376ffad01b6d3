#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "lancet/experiments/precision/box_field.hpp"
#include "lancet/experiments/precision/run.hpp"
#include "lancet/kernels/rotation/rotation_kernels.hpp"

namespace lancet::experiments::precision {

/// Throws lancet::Error for an unknown name.
[[nodiscard]] kernels::RotationMethod rotation_method(const std::string& name);

/// Elements of the mesh of a box with five tetrahedra to a cell.
[[nodiscard]] std::size_t elements_of(const std::array<int, 3>& cells);

/// Positions of the nodes of a box as displacements from its rest.
[[nodiscard]] BoxField displacement_field(const mesh::Box& box, std::span<const Point> positions);

/// Points out of x, y, z of every node.
[[nodiscard]] std::vector<Point> points_of(std::span<const double> numbers);

/// What settings have in common that differ in the mesh alone.
[[nodiscard]] std::string family(const Setting& setting);

[[nodiscard]] inline double percent(double part, double whole) {
    return 100 * part / whole;
}

}  // namespace lancet::experiments::precision
