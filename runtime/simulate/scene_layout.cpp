#include "lancet/runtime/simulate/scene_layout.hpp"

#include <cmath>
#include <string>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/cut/part_mass.hpp"

namespace lancet::runtime {

void validate_constraints(const Scene& scene) {
    const std::size_t nodes = scene.mesh.nodes().size();
    const auto exists = [&](std::int32_t node) { return node >= 0 && static_cast<std::size_t>(node) < nodes; };
    for (const std::int32_t node : scene.fixed_nodes) {
        if (!exists(node)) {
            throw Error("scene: fixed node " + std::to_string(node) + "; the mesh has nodes 0 to " +
                        std::to_string(static_cast<std::int64_t>(nodes) - 1));
        }
    }
    std::vector<int> axes(nodes, 0);
    for (const PrescribedDisplacement& p : scene.prescribed) {
        const std::string what =
            "prescribed displacement of node " + std::to_string(p.node) + ", axis " + std::to_string(p.axis);
        if (!exists(p.node) || p.axis < 0 || p.axis > 2 || !p.displacement) {
            throw Error(what + ": expected a node of the mesh, axis 0, 1 or 2, and a function");
        }
        int& known = axes[static_cast<std::size_t>(p.node)];
        if ((known & (1 << p.axis)) != 0) throw Error(what + ": given twice");
        known |= 1 << p.axis;
    }
}

void validate_parts(const Scene& scene) {
    const ElementParts& parts = scene.parts;
    if (parts.empty()) return;
    const std::size_t elements = scene.mesh.tetrahedra().size();
    if (parts.place.size() != elements) {
        throw Error("scene: parts for " + std::to_string(parts.place.size()) + " elements; the mesh has " +
                    std::to_string(elements));
    }
    for (std::size_t e = 0; e < elements; ++e) {
        if (parts.place[e] >= static_cast<std::int64_t>(parts.moments.size())) {
            throw Error("scene: element " + std::to_string(e) + " has the moments " + std::to_string(parts.place[e]) +
                        "; there are " + std::to_string(parts.moments.size()));
        }
        const mesh::PartMoments moments = parts.of(e);
        bool is_good = moments.fraction > 0 && std::isfinite(moments.fraction);
        for (std::size_t i = 0; i < 4; ++i) {
            is_good = is_good && moments.first[i] >= 0 && std::isfinite(moments.first[i]);
            for (std::size_t j = 0; j < 4; ++j) {
                is_good = is_good && moments.second[i][j] >= 0 && std::isfinite(moments.second[i][j]);
            }
        }
        if (!is_good) {
            throw Error("scene: the part of element " + std::to_string(e) +
                        " has moments that are not positive and finite");
        }
    }
}

void require_preconditioner(const Scene& scene, PreconditionerKind kind) {
    if (scene.parts.empty() || kind != PreconditionerKind::none) return;
    throw Error(
        "scene: without a preconditioner conjugate gradients do not see thin parts of cut elements; expected jacobi, "
        "block-jacobi or coarse, or force_preconditioner");
}

kernels::NodeNumbering number_scene(const Scene& scene, mesh::OrderingKind kind,
                                    const kernels::NumberingOptions& options) {
    const std::span<const mesh::Point> nodes = scene.mesh.nodes();
    std::vector<std::uint8_t> fixed(nodes.size(), 0);
    validate_constraints(scene);
    for (const std::int32_t node : scene.fixed_nodes) fixed[static_cast<std::size_t>(node)] = 1;
    const mesh::Ordering ordering = mesh::order(scene.mesh, kind);
    return kernels::number_nodes(nodes, scene.mesh.tetrahedra(), fixed, ordering.new_of_node, options);
}

ElementMaterials element_materials(const Scene& scene) {
    validate_parts(scene);
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
    for (std::size_t e = 0; e < scene.parts.place.size(); ++e) {
        materials.fractions.push_back(scene.parts.of(e).fraction);
    }
    return materials;
}

std::vector<double> nodal_masses(const Scene& scene, const ElementMaterials& materials,
                                 const kernels::NodeNumbering& numbering, MassKind kind) {
    std::vector<double> mass(static_cast<std::size_t>(numbering.node_count), 0.0);
    const std::span<const mesh::Tetrahedron> tetrahedra = scene.mesh.tetrahedra();
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
        const double whole = materials.parameters[materials.of_element[e]].density *
                             kernels::tetrahedron_geometry(scene.mesh.nodes(), tetrahedra[e]).volume;
        const std::array<double, 4> share = corner_masses(kind, scene.parts.of(e));
        for (std::size_t corner = 0; corner < 4; ++corner) {
            mass[numbering.internal_of_user[tetrahedra[e][corner]]] += share[corner] * whole;
        }
    }
    return mass;
}

template <class Real>
kernels::ElementBatches<Real> element_batches(const Scene& scene, const kernels::NodeNumbering& numbering,
                                              kernels::ScatterStrategy scatter, int width, MassKind mass) {
    const ElementMaterials materials = element_materials(scene);
    const std::span<const mesh::Tetrahedron> tetrahedra = scene.mesh.tetrahedra();
    auto batches =
        kernels::make_element_batches<Real>(scene.mesh.nodes(), tetrahedra, materials.of_element, materials.parameters,
                                            numbering, scatter, width, materials.fractions);
    if (mass != MassKind::consistent) return batches;
    std::vector<std::array<double, 6>> pairs(tetrahedra.size());
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
        const double whole = materials.parameters[materials.of_element[e]].density *
                             kernels::tetrahedron_geometry(scene.mesh.nodes(), tetrahedra[e]).volume;
        const auto share = corner_mass_matrix(mass, scene.parts.of(e));
        for (std::size_t pair = 0; pair < 6; ++pair) {
            const auto& [i, j] = kernels::corner_pairs[pair];
            pairs[e][pair] = whole * share[i][j];
        }
    }
    kernels::set_pair_masses(batches, std::span<const std::array<double, 6>>(pairs));
    return batches;
}

template kernels::ElementBatches<float> element_batches<float>(const Scene&, const kernels::NodeNumbering&,
                                                               kernels::ScatterStrategy, int, MassKind);
template kernels::ElementBatches<double> element_batches<double>(const Scene&, const kernels::NodeNumbering&,
                                                                 kernels::ScatterStrategy, int, MassKind);

}  // namespace lancet::runtime
