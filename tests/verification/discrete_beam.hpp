#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "tests/verification/reference_table.hpp"

#include "lancet/runtime/simulate/scene.hpp"

namespace lancet::test {

/// The beam of the discrete references, 0.03 x 0.06 x 0.2 m, clamped at z = 0, under gravity along x. `mesh` is the
/// name of its mesh there; empty where the folder is absent.
inline runtime::Scene discrete_beam(const std::string& mesh) {
    const auto folder = reference_folder() / "discrete";
    mesh::TetMesh::Definition definition;
    for (const auto& row : read_numbers(folder / ("mesh_" + mesh + "_nodes.csv"))) {
        definition.nodes.push_back({row[1], row[2], row[3]});
    }
    for (const auto& row : read_numbers(folder / ("mesh_" + mesh + "_tets.csv"))) {
        definition.tetrahedra.push_back({static_cast<std::int32_t>(row[1]), static_cast<std::int32_t>(row[2]),
                                         static_cast<std::int32_t>(row[3]), static_cast<std::int32_t>(row[4])});
    }
    runtime::Scene scene;
    scene.mesh = mesh::TetMesh(std::move(definition));
    for (std::size_t node = 0; node < scene.mesh.nodes().size(); ++node) {
        if (scene.mesh.nodes()[node][2] == 0) scene.fixed_nodes.push_back(static_cast<std::int32_t>(node));
    }
    scene.materials = {{0, {.young_modulus = 3e5, .poisson_ratio = 0.35, .density = 1070}}};
    scene.gravity = {9.81, 0, 0};
    return scene;
}

/// The largest difference of two displacements, against the largest displacement.
inline double largest_difference(std::span<const mesh::Point> found, std::span<const mesh::Point> expected) {
    double largest = 0, difference = 0;
    for (std::size_t node = 0; node < expected.size(); ++node) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            largest = std::max(largest, std::abs(expected[node][axis]));
            difference = std::max(difference, std::abs(found[node][axis] - expected[node][axis]));
        }
    }
    return difference / largest;
}

inline std::vector<mesh::Point> displacements(std::span<const mesh::Point> rest, std::span<const mesh::Point> moved) {
    std::vector<mesh::Point> differences;
    for (std::size_t node = 0; node < rest.size(); ++node) {
        differences.push_back(
            {moved[node][0] - rest[node][0], moved[node][1] - rest[node][1], moved[node][2] - rest[node][2]});
    }
    return differences;
}

}  // namespace lancet::test
