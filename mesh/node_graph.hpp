#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh {

/// Which nodes share an element, in compressed rows: the neighbours of node n, ascending and without n itself, are
/// neighbours[first[n]] to neighbours[first[n + 1] - 1].
struct NodeGraph {
    std::vector<std::size_t> first;
    std::vector<std::int32_t> neighbours;

    std::size_t node_count() const { return first.empty() ? 0 : first.size() - 1; }
    std::size_t degree(std::int32_t node) const { return first[node + std::size_t{1}] - first[node]; }
    std::span<const std::int32_t> of(std::int32_t node) const {
        return std::span(neighbours).subspan(first[node], degree(node));
    }
};

NodeGraph node_graph(const TetMesh& mesh);

/// The reverse Cuthill-McKee ordering: old number of each new node. Components follow each other.
std::vector<std::int32_t> reverse_cuthill_mckee(const NodeGraph& graph);

}  // namespace lancet::mesh
