#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh {

/// What repair() may do. Turning and dropping unused nodes do not change the body; dropping elements does.
struct RepairOptions {
    bool turn_inverted = true;
    bool drop_isolated_nodes = true;
    /// Flat elements and those with a repeated node.
    bool drop_flat = false;
    /// Later copies of elements with the same four nodes.
    bool drop_duplicates = false;
};

/// A repaired definition and how it came about. Nothing is done that `notes` does not say.
struct Repaired {
    TetMesh::Definition definition;
    /// One readable line for each kind of change; empty if there was none.
    std::vector<std::string> notes;
    /// Old number of each new node and element.
    std::vector<std::int32_t> node_of_new, element_of_new;
    /// New number of each old node and element, -1 for what was dropped.
    std::vector<std::int32_t> new_of_node, new_of_element;
};

/// Repairs what the options allow; what remains wrong is left for TetMesh to refuse. Inverted elements are turned by
/// swapping their last two nodes. Numbers keep their order.
Repaired repair(TetMesh::Definition definition, const RepairOptions& options = {});

}  // namespace lancet::mesh
