#include "lancet/runtime/cut/divided_scene.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/cut/boundary_shares.hpp"
#include "lancet/mesh/cut/lanes.hpp"
#include "lancet/runtime/simulate/loads.hpp"

namespace lancet::runtime {

namespace {

constexpr double thinnest = 1e-20;

/// The lanes as elements, with their moments.
void take_lanes(const Scene& scene, const mesh::Lanes& lanes, Scene& divided, mesh::TetMesh::Definition& definition) {
    for (const mesh::Lanes::Lane& lane : lanes.lanes) {
        const bool is_whole = lane.moments.fraction == 1;
        if (!is_whole && divided.parts.empty()) divided.parts.place.assign(lanes.lanes.size(), -1);
        if (!is_whole) {
            divided.parts.place[definition.tetrahedra.size()] = static_cast<std::int32_t>(divided.parts.moments.size());
            divided.parts.moments.push_back(lane.moments.fraction < thinnest ? smallest_moments() : lane.moments);
        }
        definition.tetrahedra.push_back(lane.copies);
        definition.regions.push_back(scene.mesh.regions()[static_cast<std::size_t>(lane.element)]);
    }
    for (const std::int32_t node : lanes.node_of_copy) {
        definition.nodes.push_back(scene.mesh.nodes()[static_cast<std::size_t>(node)]);
    }
}

/// The element of a cut mesh that has all these nodes; the first, where there are several.
template <std::size_t Count>
std::int32_t element_with(const mesh::CutMesh& cut, const std::array<std::int32_t, Count>& nodes) {
    for (const std::int32_t element : cut.star(nodes[0])) {
        const mesh::Tetrahedron& corners = cut.mesh().tetrahedra()[static_cast<std::size_t>(element)];
        if (std::ranges::all_of(nodes, [&](auto node) { return std::ranges::find(corners, node) != corners.end(); })) {
            return element;
        }
    }
    return -1;
}

/// A dead force on a triangle or an edge, spread over the parts there. Returns false where no cut touches it.
template <std::size_t Count>
bool spread(const mesh::CutMesh& cut, const std::array<std::int32_t, Count>& nodes, const Point& force,
            std::vector<NodalLoad>& loads) {
    const std::int32_t element = element_with(cut, nodes);
    const mesh::ElementCells* cells = element < 0 ? nullptr : cut.cells(element);
    if (element < 0) return false;
    const mesh::Tetrahedron& corners = cut.mesh().tetrahedra()[static_cast<std::size_t>(element)];
    const auto corner_of = [&](std::int32_t node) {
        return static_cast<int>(std::ranges::find(corners, node) - corners.begin());
    };
    std::vector<mesh::BoundaryShare> shares;
    if (cells == nullptr) {
        mesh::BoundaryShare whole;
        for (const std::int32_t node : nodes) {
            whole.first[static_cast<std::size_t>(corner_of(node))] = 1.0 / static_cast<double>(Count);
        }
        shares.push_back(whole);
    } else if constexpr (Count == 3) {
        shares = face_shares(*cells, 6 - corner_of(nodes[0]) - corner_of(nodes[1]) - corner_of(nodes[2]));
    } else {
        shares = edge_shares(*cells, corner_of(nodes[0]), corner_of(nodes[1]));
    }
    const std::vector<std::int32_t> parts = cut.parts_of_element(element);
    for (const mesh::BoundaryShare& share : shares) {
        const mesh::Tetrahedron& copies =
            cut.parts()[static_cast<std::size_t>(parts[static_cast<std::size_t>(share.part)])];
        for (std::size_t k = 0; k < 4; ++k) {
            if (share.first[k] == 0) continue;
            loads.push_back(
                {copies[k], {share.first[k] * force[0], share.first[k] * force[1], share.first[k] * force[2]}});
        }
    }
    return true;
}

}  // namespace

mesh::PartMoments smallest_moments() {
    mesh::PartMoments moments = mesh::empty_moments();
    add_weighted(moments, mesh::PartMoments{}, thinnest);
    return moments;
}

Scene divided(const Scene& scene, const mesh::CutMesh& cut, mesh::Fronts fronts, std::vector<std::int32_t>* opened_from,
              double smallest_fraction) {
    if (!scene.parts.empty()) throw Error("cuts: the scene has been divided before; divide the one without cuts");
    if (scene.mesh.nodes().size() != cut.mesh().nodes().size() ||
        !std::ranges::equal(scene.mesh.tetrahedra(), cut.mesh().tetrahedra())) {
        throw Error("cuts: the cut mesh is not the scene's");
    }
    // What the loads refer to is checked in the scene as it was given.
    (void)external_loads(scene);
    Scene result = scene;
    mesh::TetMesh::Definition definition;
    definition.region_names = scene.mesh.region_names();
    mesh::Lanes lanes = mesh::lanes(cut, fronts);
    raise_fractions(lanes, smallest_fraction);
    if (opened_from != nullptr) *opened_from = lanes.opened_from;
    take_lanes(scene, lanes, result, definition);
    std::map<std::int32_t, std::vector<std::int32_t>> opening;
    for (std::size_t copy = cut.node_of_copy().size(); copy < lanes.node_of_copy.size(); ++copy) {
        opening[lanes.node_of_copy[copy]].push_back(static_cast<std::int32_t>(copy));
    }
    const auto copies_of = [&](std::int32_t node) {
        std::vector<std::int32_t> copies = cut.copies_of_node(node);
        const auto found = opening.find(node);
        if (found != opening.end()) copies.insert(copies.end(), found->second.begin(), found->second.end());
        return copies;
    };
    const auto all_copies = [&](std::span<const std::int32_t> nodes) {
        std::vector<std::int32_t> copies;
        for (const std::int32_t node : nodes) {
            const std::vector<std::int32_t> of_node = copies_of(node);
            copies.insert(copies.end(), of_node.begin(), of_node.end());
        }
        return copies;
    };
    for (const auto& [name, nodes] : scene.mesh.node_sets()) definition.node_sets[name] = all_copies(nodes);
    result.mesh = mesh::TetMesh(std::move(definition));
    result.fixed_nodes = all_copies(scene.fixed_nodes);
    result.prescribed.clear();
    for (const PrescribedDisplacement& prescribed : scene.prescribed) {
        for (const std::int32_t copy : copies_of(prescribed.node)) {
            result.prescribed.push_back({copy, prescribed.axis, prescribed.displacement});
        }
    }
    result.edge_loads.clear();
    for (const EdgeLoad& load : scene.edge_loads) {
        const Point &a = scene.mesh.nodes()[static_cast<std::size_t>(load.nodes[0])],
                    &b = scene.mesh.nodes()[static_cast<std::size_t>(load.nodes[1])];
        const double length = std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
        const Point force{length * load.force_per_length[0], length * load.force_per_length[1],
                          length * load.force_per_length[2]};
        if (!spread(cut, load.nodes, force, result.nodal_loads)) result.edge_loads.push_back(load);
    }
    result.tractions.clear();
    for (const Traction& traction : scene.tractions) {
        Traction left{.triangles = {}, .force_per_area = traction.force_per_area};
        for (const auto& triangle : traction.triangles) {
            const double area = mesh::area(scene.mesh.nodes()[static_cast<std::size_t>(triangle[0])],
                                           scene.mesh.nodes()[static_cast<std::size_t>(triangle[1])],
                                           scene.mesh.nodes()[static_cast<std::size_t>(triangle[2])]);
            const Point force{area * traction.force_per_area[0], area * traction.force_per_area[1],
                              area * traction.force_per_area[2]};
            if (!spread(cut, triangle, force, result.nodal_loads)) left.triangles.push_back(triangle);
        }
        if (!left.triangles.empty()) result.tractions.push_back(std::move(left));
    }
    return result;
}

}  // namespace lancet::runtime
