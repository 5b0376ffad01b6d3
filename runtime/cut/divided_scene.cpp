#include "lancet/runtime/cut/divided_scene.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/cut/lanes.hpp"
#include "lancet/runtime/cut/divided_loads.hpp"

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
            divided.parts.moments.push_back(at_least_smallest(lane.moments));
        }
        definition.tetrahedra.push_back(lane.copies);
        definition.regions.push_back(scene.mesh.regions()[static_cast<std::size_t>(lane.element)]);
    }
    for (const std::int32_t node : lanes.node_of_copy) {
        definition.nodes.push_back(scene.mesh.nodes()[static_cast<std::size_t>(node)]);
    }
}

}  // namespace

mesh::PartMoments smallest_moments() {
    mesh::PartMoments moments = mesh::empty_moments();
    add_weighted(moments, mesh::PartMoments{}, thinnest);
    return moments;
}

mesh::PartMoments at_least_smallest(const mesh::PartMoments& moments) {
    return moments.fraction < thinnest ? smallest_moments() : moments;
}

Scene divided(const Scene& scene, const mesh::CutMesh& cut, mesh::Fronts fronts, std::vector<std::int32_t>* opened_from,
              double smallest_fraction) {
    if (!scene.parts.empty()) throw Error("cuts: the scene has been divided before; divide the one without cuts");
    if (scene.mesh.nodes().size() != cut.mesh().nodes().size() ||
        !std::ranges::equal(scene.mesh.tetrahedra(), cut.mesh().tetrahedra())) {
        throw Error("cuts: the cut mesh is not the scene's");
    }
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
    result.tractions.clear();
    const DividedLoads loads(scene, cut);
    result.nodal_loads.assign(loads.on_copies().begin(), loads.on_copies().end());
    return result;
}

}  // namespace lancet::runtime
