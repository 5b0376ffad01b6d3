#include "lancet/mesh/components.hpp"

#include <numeric>

namespace lancet::mesh {

namespace {

/// Root of a node in a union-find forest, halving the path on the way.
std::int32_t root(std::vector<std::int32_t>& parent, std::int32_t node) {
    while (parent[node] != node) {
        parent[node] = parent[parent[node]];
        node = parent[node];
    }
    return node;
}

}  // namespace

Components components(const TetMesh& mesh) {
    return components(mesh.nodes().size(), mesh.tetrahedra());
}

Components components(std::size_t nodes, std::span<const Tetrahedron> tetrahedra) {
    std::vector<std::int32_t> parent(nodes);
    std::iota(parent.begin(), parent.end(), 0);
    for (const Tetrahedron& t : tetrahedra) {
        for (std::size_t n = 1; n < 4; ++n) {
            const std::int32_t a = root(parent, t[0]);
            const std::int32_t b = root(parent, t[n]);
            // The lower number is the root, which makes the numbering of components follow the lowest nodes.
            if (a < b) parent[b] = a;
            if (b < a) parent[a] = b;
        }
    }
    Components result;
    result.of_node.resize(nodes);
    for (std::size_t n = 0; n < parent.size(); ++n) {
        const auto node = static_cast<std::int32_t>(n);
        const std::int32_t lowest = root(parent, node);
        result.of_node[n] = lowest == node ? result.count++ : result.of_node[lowest];
    }
    result.of_element.reserve(tetrahedra.size());
    for (const Tetrahedron& t : tetrahedra) result.of_element.push_back(result.of_node[t[0]]);
    return result;
}

}  // namespace lancet::mesh
