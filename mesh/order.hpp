#pragma once

#include <cstdint>
#include <vector>

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh {

/// A renumbering of nodes and elements with its inverse: new_of_node[node_of_new[n]] == n.
struct Ordering {
    std::vector<std::int32_t> node_of_new;
    std::vector<std::int32_t> new_of_node;
    std::vector<std::int32_t> element_of_new;
    std::vector<std::int32_t> new_of_element;
};

enum class OrderingKind {
    /// Nodes and elements stay as they are.
    none,
    /// Nodes along Hilbert's curve through the bounding cube (2^21 places to a side), equal places by number.
    hilbert,
    /// Nodes by reversed breadth-first levels from a node far out, neighbours of low degree first, each connected
    /// component by itself (Cuthill and McKee 1969, George and Liu 1979).
    reverse_cuthill_mckee
};

/// Computes an ordering. Except for `none`, elements are sorted by their lowest new node, then the second lowest, and
/// so on. The result depends on the mesh alone.
Ordering order(const TetMesh& mesh, OrderingKind kind);

/// The same mesh in the new numbering; the order of the nodes within elements is kept, and with it the orientation.
/// @throws lancet::Error where the ordering is not a pair of permutations of the mesh.
TetMesh reordered(const TetMesh& mesh, const Ordering& ordering);

}  // namespace lancet::mesh
