#include "lancet/mesh/order.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <string>
#include <utility>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/node_graph.hpp"

namespace lancet::mesh {

namespace {

constexpr int hilbert_bits = 21;

/// Place on Hilbert's curve of a cell of the cube (Skilling 2004, "Programming the Hilbert curve").
std::uint64_t hilbert_place(std::array<std::uint32_t, 3> x) {
    for (std::uint32_t bit = 1U << (hilbert_bits - 1); bit > 1; bit >>= 1) {
        const std::uint32_t below = bit - 1;
        for (std::uint32_t& value : x) {
            if ((value & bit) != 0) {
                x[0] ^= below;
            } else {
                const std::uint32_t swapped = (x[0] ^ value) & below;
                x[0] ^= swapped;
                value ^= swapped;
            }
        }
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    std::uint32_t flip = 0;
    for (std::uint32_t bit = 1U << (hilbert_bits - 1); bit > 1; bit >>= 1) {
        if ((x[2] & bit) != 0) flip ^= bit - 1;
    }
    std::uint64_t place = 0;
    for (int bit = hilbert_bits - 1; bit >= 0; --bit) {
        for (const std::uint32_t value : x) place = (place << 1) | (((value ^ flip) >> bit) & 1U);
    }
    return place;
}

std::vector<std::int32_t> along_hilbert_curve(const TetMesh& mesh) {
    const auto [low, high] = mesh.bounds();
    double half_extent = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) half_extent = std::max(half_extent, high[axis] / 2 - low[axis] / 2);
    constexpr double last = (1U << hilbert_bits) - 1;
    std::vector<std::pair<std::uint64_t, std::int32_t>> places;
    places.reserve(mesh.nodes().size());
    for (const Point& x : mesh.nodes()) {
        std::array<std::uint32_t, 3> cell{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double fraction = (x[axis] / 2 - low[axis] / 2) / half_extent;
            cell[axis] = static_cast<std::uint32_t>(std::clamp(fraction, 0.0, 1.0) * last);
        }
        places.emplace_back(hilbert_place(cell), static_cast<std::int32_t>(places.size()));
    }
    std::sort(places.begin(), places.end());
    std::vector<std::int32_t> node_of_new;
    node_of_new.reserve(places.size());
    for (const auto& [place, node] : places) node_of_new.push_back(node);
    return node_of_new;
}

std::vector<std::int32_t> inverse(const std::vector<std::int32_t>& old_of_new) {
    std::vector<std::int32_t> new_of_old(old_of_new.size());
    for (std::size_t n = 0; n < old_of_new.size(); ++n) new_of_old[old_of_new[n]] = static_cast<std::int32_t>(n);
    return new_of_old;
}

std::vector<std::int32_t> count_up(std::size_t size) {
    std::vector<std::int32_t> numbers(size);
    std::iota(numbers.begin(), numbers.end(), 0);
    return numbers;
}

std::vector<std::int32_t> elements_by_nodes(const TetMesh& mesh, const std::vector<std::int32_t>& new_of_node) {
    std::vector<std::pair<Tetrahedron, std::int32_t>> keys;
    keys.reserve(mesh.tetrahedra().size());
    for (Tetrahedron t : mesh.tetrahedra()) {
        for (std::int32_t& node : t) node = new_of_node[node];
        std::sort(t.begin(), t.end());
        keys.emplace_back(t, static_cast<std::int32_t>(keys.size()));
    }
    std::sort(keys.begin(), keys.end());
    std::vector<std::int32_t> element_of_new;
    element_of_new.reserve(keys.size());
    for (const auto& [nodes, element] : keys) element_of_new.push_back(element);
    return element_of_new;
}

void check_permutation(const std::vector<std::int32_t>& old_of_new, const std::vector<std::int32_t>& new_of_old,
                       std::size_t size, const std::string& what) {
    bool valid = old_of_new.size() == size && new_of_old.size() == size;
    for (std::size_t n = 0; valid && n < size; ++n) {
        const std::int32_t old = old_of_new[n];
        valid = old >= 0 && static_cast<std::size_t>(old) < size && static_cast<std::size_t>(new_of_old[old]) == n;
    }
    if (!valid) {
        throw Error("ordering: the numbers of the " + what + " are not a permutation of the " + std::to_string(size) +
                    ' ' + what + " of the mesh with its inverse");
    }
}

}  // namespace

Ordering order(const TetMesh& mesh, OrderingKind kind) {
    Ordering result;
    switch (kind) {
        case OrderingKind::none:
            result.node_of_new = count_up(mesh.nodes().size());
            break;
        case OrderingKind::hilbert:
            result.node_of_new = along_hilbert_curve(mesh);
            break;
        case OrderingKind::reverse_cuthill_mckee:
            result.node_of_new = reverse_cuthill_mckee(node_graph(mesh));
            break;
    }
    result.new_of_node = inverse(result.node_of_new);
    result.element_of_new =
        kind == OrderingKind::none ? count_up(mesh.tetrahedra().size()) : elements_by_nodes(mesh, result.new_of_node);
    result.new_of_element = inverse(result.element_of_new);
    return result;
}

TetMesh reordered(const TetMesh& mesh, const Ordering& ordering) {
    check_permutation(ordering.node_of_new, ordering.new_of_node, mesh.nodes().size(), "nodes");
    check_permutation(ordering.element_of_new, ordering.new_of_element, mesh.tetrahedra().size(), "elements");
    TetMesh::Definition result;
    result.nodes.reserve(mesh.nodes().size());
    for (const std::int32_t node : ordering.node_of_new) result.nodes.push_back(mesh.nodes()[node]);
    result.tetrahedra.reserve(mesh.tetrahedra().size());
    result.regions.reserve(mesh.tetrahedra().size());
    for (const std::int32_t element : ordering.element_of_new) {
        Tetrahedron t = mesh.tetrahedra()[element];
        for (std::int32_t& node : t) node = ordering.new_of_node[node];
        result.tetrahedra.push_back(t);
        result.regions.push_back(mesh.regions()[element]);
    }
    result.node_sets = mesh.node_sets();
    for (auto& [name, members] : result.node_sets) {
        for (std::int32_t& node : members) node = ordering.new_of_node[node];
    }
    result.region_names = mesh.region_names();
    return TetMesh(std::move(result));
}

}  // namespace lancet::mesh
