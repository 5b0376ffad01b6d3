#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh {

/// The element behind each face, [element][corner opposite the face]; -1 where there is none, or more than one.
std::vector<std::array<std::int32_t, 4>> face_neighbours(const TetMesh& mesh);

/// The elements around each node, in compressed rows and ascending.
struct NodeStars {
    std::vector<std::size_t> first;
    std::vector<std::int32_t> elements;

    std::span<const std::int32_t> of(std::int32_t node) const {
        const auto n = static_cast<std::size_t>(node);
        return std::span(elements).subspan(first[n], first[n + 1] - first[n]);
    }
};
NodeStars node_stars(const TetMesh& mesh);

}  // namespace lancet::mesh
