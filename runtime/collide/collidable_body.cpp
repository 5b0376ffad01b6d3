#include "lancet/runtime/collide/collidable_body.hpp"

#include <algorithm>
#include <string>

#include "lancet/kernels/error.hpp"
#include "lancet/kernels/layout/aligned_vector.hpp"

namespace lancet::runtime {
namespace {

template <class Primitive>
void require_nodes(std::span<const Primitive> primitives, std::size_t nodes, const std::string& what) {
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        for (const std::int32_t node : primitives[i]) {
            if (node >= 0 && static_cast<std::size_t>(node) < nodes) continue;
            throw Error(what + " " + std::to_string(i) + " has node " + std::to_string(node) + "; expected 0 to " +
                        std::to_string(nodes) + " - 1");
        }
    }
}

mesh::Triangle sorted(mesh::Triangle triangle) {
    std::ranges::sort(triangle);
    return triangle;
}

/// The faces of tetrahedra that are among the triangles, as bits by the opposite corner.
std::vector<std::uint8_t> faces_among(std::span<const mesh::Tetrahedron> tetrahedra,
                                      std::span<const mesh::Triangle> triangles) {
    std::vector<mesh::Triangle> known(triangles.size());
    std::ranges::transform(triangles, known.begin(), sorted);
    std::ranges::sort(known);
    std::vector<std::uint8_t> bits(tetrahedra.size(), 0);
    for (std::size_t i = 0; i < tetrahedra.size(); ++i) {
        for (std::size_t corner = 0; corner < 4; ++corner) {
            mesh::Triangle face = mesh::opposite_faces[corner];
            for (std::int32_t& node : face) node = tetrahedra[i][static_cast<std::size_t>(node)];
            if (std::ranges::binary_search(known, sorted(face))) bits[i] |= static_cast<std::uint8_t>(1U << corner);
        }
    }
    return bits;
}

}  // namespace

CollidableBody::CollidableBody(std::size_t nodes, std::span<const mesh::Tetrahedron> tetrahedra,
                               std::span<const mesh::Triangle> surface, BroadPhaseKind kind)
    : tetrahedra_(tetrahedra.begin(), tetrahedra.end()),
      surface_(surface.begin(), surface.end()),
      first_neighbour_(nodes + 1, 0),
      positions_(nodes),
      node_boxes_(nodes, empty_box),
      tetrahedron_boxes_(make_broad_phase(kind)),
      surface_boxes_(make_broad_phase(kind)) {
    require_nodes(tetrahedra, nodes, "tetrahedron");
    require_nodes(surface, nodes, "triangle of the surface");
    for (const mesh::Tetrahedron& element : tetrahedra_) {
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                edges_.push_back({std::min(element[i], element[j]), std::max(element[i], element[j])});
            }
        }
    }
    std::ranges::sort(edges_);
    edges_.erase(std::ranges::unique(edges_).begin(), edges_.end());
    edges_.shrink_to_fit();
    for (const auto& [a, b] : edges_) {
        ++first_neighbour_[a + 1];
        ++first_neighbour_[b + 1];
    }
    for (std::size_t node = 0; node < nodes; ++node) first_neighbour_[node + 1] += first_neighbour_[node];
    neighbours_.resize(2 * edges_.size());
    std::vector<std::int32_t> next(first_neighbour_.begin(), first_neighbour_.end() - 1);
    for (const auto& [a, b] : edges_) {
        neighbours_[next[a]++] = b;
        neighbours_[next[b]++] = a;
    }
    for (std::size_t node = 0; node < nodes; ++node) {
        std::sort(neighbours_.begin() + first_neighbour_[node], neighbours_.begin() + first_neighbour_[node + 1]);
    }
    surface_faces_ = faces_among(tetrahedra_, surface_);
    boxes_.resize(std::max(tetrahedra_.size(), surface_.size()));
}

void CollidableBody::update(std::span<const Point> positions) {
    if (positions.size() != positions_.size()) {
        throw Error("collision: " + std::to_string(positions.size()) + " positions; expected " +
                    std::to_string(positions_.size()) + ", one for each node");
    }
    std::ranges::copy(positions, positions_.begin());
    for (std::size_t node = 0; node < positions_.size(); ++node) {
        if (first_neighbour_[node] == first_neighbour_[node + 1]) continue;
        node_boxes_[node] = {positions_[node], positions_[node]};
    }
    const auto take = [this](BroadPhase& phase, const auto& primitives) {
        const std::span boxes = std::span(boxes_).first(primitives.size());
        boxes_around(std::span<const Point>(positions_), std::span(primitives), 0, boxes);
        if (is_built_) {
            phase.refit(boxes);
        } else {
            phase.build(boxes);
        }
    };
    take(*tetrahedron_boxes_, std::as_const(tetrahedra_));
    take(*surface_boxes_, std::as_const(surface_));
    is_built_ = true;
}

std::size_t CollidableBody::bytes() const noexcept {
    using kernels::heap_bytes;
    return heap_bytes(tetrahedra_) + heap_bytes(surface_) + heap_bytes(edges_) + heap_bytes(surface_faces_) +
           heap_bytes(first_neighbour_) + heap_bytes(neighbours_) + heap_bytes(positions_) + heap_bytes(node_boxes_) +
           heap_bytes(boxes_) + tetrahedron_boxes_->bytes() + surface_boxes_->bytes();
}

}  // namespace lancet::runtime
