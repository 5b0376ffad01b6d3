#include "lancet/runtime/simulate/scene_layout.hpp"

#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {

kernels::NodeNumbering number_scene(const Scene& scene, mesh::OrderingKind kind,
                                    const kernels::NumberingOptions& options) {
    const std::span<const mesh::Point> nodes = scene.mesh.nodes();
    std::vector<std::uint8_t> fixed(nodes.size(), 0);
    for (const std::int32_t node : scene.fixed_nodes) {
        if (node < 0 || static_cast<std::size_t>(node) >= nodes.size()) {
            throw Error("scene: fixed node " + std::to_string(node) + "; the mesh has nodes 0 to " +
                        std::to_string(nodes.size() - 1));
        }
        fixed[node] = 1;
    }
    const mesh::Ordering ordering = mesh::order(scene.mesh, kind);
    return kernels::number_nodes(nodes, scene.mesh.tetrahedra(), fixed, ordering.new_of_node, options);
}

ElementMaterials element_materials(const Scene& scene) {
    if (!scene.materials.contains(0)) throw Error("scene: region 0 has no material");
    ElementMaterials materials;
    std::map<int, std::int32_t> place;
    for (const auto& [region, material] : scene.materials) {
        place[region] = static_cast<std::int32_t>(materials.parameters.size());
        materials.parameters.push_back(elastic_parameters(material));
    }
    for (const std::int32_t region : scene.mesh.regions()) {
        const auto found = place.find(region);
        materials.of_element.push_back(found != place.end() ? found->second : place[0]);
    }
    return materials;
}

std::vector<double> nodal_masses(const Scene& scene, const ElementMaterials& materials,
                                 const kernels::NodeNumbering& numbering) {
    std::vector<double> mass(static_cast<std::size_t>(numbering.node_count), 0.0);
    const std::span<const mesh::Tetrahedron> tetrahedra = scene.mesh.tetrahedra();
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
        const double quarter = materials.parameters[materials.of_element[e]].density *
                               kernels::tetrahedron_geometry(scene.mesh.nodes(), tetrahedra[e]).volume / 4;
        for (const std::int32_t node : tetrahedra[e]) mass[numbering.internal_of_user[node]] += quarter;
    }
    return mass;
}

}  // namespace lancet::runtime
