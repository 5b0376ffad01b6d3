#include "lancet/runtime/cut/divided_loads.hpp"

#include <algorithm>
#include <cmath>

#include "lancet/mesh/cut/boundary_shares.hpp"
#include "lancet/runtime/simulate/loads.hpp"

namespace lancet::runtime {

namespace {

using mesh::Point;

Point scaled(double factor, const Point& vector) {
    return {factor * vector[0], factor * vector[1], factor * vector[2]};
}

/// The element of a cut mesh that has all these nodes; the first, where there are several.
std::int32_t element_with(const mesh::CutMesh& cut, std::span<const std::int32_t> nodes) {
    for (const std::int32_t element : cut.star(nodes[0])) {
        const mesh::Tetrahedron& corners = cut.mesh().tetrahedra()[static_cast<std::size_t>(element)];
        if (std::ranges::all_of(nodes, [&](auto node) { return std::ranges::find(corners, node) != corners.end(); })) {
            return element;
        }
    }
    return -1;
}

}  // namespace

DividedLoads::DividedLoads(const Scene& scene, const mesh::CutMesh& cut) : on_nodes_(scene.nodal_loads) {
    // What the loads refer to is checked in the scene as it was given.
    (void)external_loads(scene);
    const auto nodes = scene.mesh.nodes();
    const auto at = [&](std::int32_t node) -> const Point& { return nodes[static_cast<std::size_t>(node)]; };
    for (const EdgeLoad& load : scene.edge_loads) {
        const Point &a = at(load.nodes[0]), &b = at(load.nodes[1]);
        const double length = std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
        add_piece(cut, load.nodes, scaled(length, load.force_per_length));
    }
    for (const Traction& traction : scene.tractions) {
        for (const mesh::Triangle& triangle : traction.triangles) {
            const double area = mesh::area(at(triangle[0]), at(triangle[1]), at(triangle[2]));
            add_piece(cut, triangle, scaled(area, traction.force_per_area));
        }
    }
    std::ranges::stable_sort(pieces_, {}, &Piece::element);
    collect();
}

void DividedLoads::add_piece(const mesh::CutMesh& cut, std::span<const std::int32_t> nodes, const Point& force) {
    Piece piece{
        .element = element_with(cut, nodes), .nodes = static_cast<int>(nodes.size()), .node = {}, .force = force};
    std::ranges::copy(nodes, piece.node.begin());
    spread(cut, piece);
    pieces_.push_back(std::move(piece));
}

void DividedLoads::spread(const mesh::CutMesh& cut, Piece& piece) {
    piece.forces.clear();
    const double equal = 1.0 / piece.nodes;
    if (piece.element < 0) {
        for (int k = 0; k < piece.nodes; ++k) {
            piece.forces.push_back({piece.node[static_cast<std::size_t>(k)], scaled(equal, piece.force)});
        }
        return;
    }
    const mesh::ElementCells* cells = cut.cells(piece.element);
    const mesh::Tetrahedron& corners = cut.mesh().tetrahedra()[static_cast<std::size_t>(piece.element)];
    const auto corner = [&](int k) {
        return static_cast<int>(std::ranges::find(corners, piece.node[static_cast<std::size_t>(k)]) - corners.begin());
    };
    std::vector<mesh::BoundaryShare> shares;
    if (cells == nullptr) {
        mesh::BoundaryShare& whole = shares.emplace_back();
        for (int k = 0; k < piece.nodes; ++k) whole.first[static_cast<std::size_t>(corner(k))] = equal;
    } else if (piece.nodes == 3) {
        shares = face_shares(*cells, 6 - corner(0) - corner(1) - corner(2));
    } else {
        shares = edge_shares(*cells, corner(0), corner(1));
    }
    const std::vector<std::int32_t> parts = cut.parts_of_element(piece.element);
    for (const mesh::BoundaryShare& share : shares) {
        const mesh::Tetrahedron& copies =
            cut.parts()[static_cast<std::size_t>(parts[static_cast<std::size_t>(share.part)])];
        for (std::size_t k = 0; k < 4; ++k) {
            if (share.first[k] != 0) piece.forces.push_back({copies[k], scaled(share.first[k], piece.force)});
        }
    }
}

void DividedLoads::update(const mesh::CutMesh& cut, std::span<const std::int32_t> elements) {
    bool is_changed = false;
    for (const std::int32_t element : elements) {
        for (Piece& piece : std::ranges::equal_range(pieces_, element, {}, &Piece::element)) {
            spread(cut, piece);
            is_changed = true;
        }
    }
    if (is_changed) collect();
}

void DividedLoads::collect() {
    forces_ = on_nodes_;
    for (const Piece& piece : pieces_) forces_.insert(forces_.end(), piece.forces.begin(), piece.forces.end());
}

}  // namespace lancet::runtime
