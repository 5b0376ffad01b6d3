#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh {

/// The connected parts of a mesh: elements that share a node are connected.
struct Components {
    std::int32_t count = 0;
    /// Component of each element and of each node, numbered in the order of their lowest node.
    std::vector<std::int32_t> of_element, of_node;
};

Components components(const TetMesh& mesh);
/// The same for elements given by their nodes, of which there are `nodes`; a node of no element is a component.
Components components(std::size_t nodes, std::span<const Tetrahedron> tetrahedra);

}  // namespace lancet::mesh
