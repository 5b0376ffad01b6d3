#include "lancet/runtime/cut/divided_inertia.hpp"

#include <algorithm>

#include "lancet/runtime/cut/part_mass.hpp"

namespace lancet::runtime {

double DividedInertia::whole_mass(const mesh::CutMesh& cut, std::int32_t element) const {
    const auto e = static_cast<std::size_t>(element);
    return materials_.parameters[static_cast<std::size_t>(materials_.of_element[e])].density *
           kernels::tetrahedron_geometry(cut.mesh().nodes(), cut.mesh().tetrahedra()[e]).volume;
}

BodyChange::NodalMass DividedInertia::nodal_mass(const mesh::CutMesh& cut, const DividedElements& elements,
                                                 CopyName name) const {
    BodyChange::NodalMass result;
    result.node = elements.node_of(cut, name);
    const CopyName copy = is_opening(name) ? opening_from(name) : name;
    for (const std::int32_t element : cut.star(cut.node_of_copy()[static_cast<std::size_t>(copy)])) {
        elements.for_each_lane(cut, element, [&](const DividedElements::Lane& lane) {
            const auto corner = static_cast<std::size_t>(std::ranges::find(lane.copies, name) - lane.copies.begin());
            if (corner == 4) return;
            const double whole = whole_mass(cut, element);
            result.mass += corner_masses(kind_, lane.moments)[corner] * whole;
            if (kind_ != MassKind::consistent) return;
            const auto shares = corner_mass_matrix(kind_, lane.moments);
            for (std::size_t other = 0; other < 4; ++other) {
                if (other == corner) continue;
                const std::int32_t node = elements.node_of(cut, lane.copies[other]);
                const auto known = std::ranges::find(result.row, node, &std::pair<std::int32_t, double>::first);
                auto& pair = known == result.row.end() ? result.row.emplace_back(node, 0.0) : *known;
                pair.second += shares[corner][other] * whole;
            }
        });
    }
    return result;
}

BodyChange::Element DividedInertia::element(const mesh::CutMesh& cut, const DividedElements& elements,
                                            const DividedElements::Change& change) const {
    const auto e = static_cast<std::size_t>(change.element);
    BodyChange::Element element{.element = change.lane.number,
                                .is_there = change.is_there,
                                .nodes = {},
                                .like = change.like,
                                .material = materials_.parameters[static_cast<std::size_t>(materials_.of_element[e])],
                                .fraction = change.lane.moments.fraction,
                                .pair_masses = {}};
    if (!change.is_there) return element;
    for (std::size_t k = 0; k < 4; ++k) element.nodes[k] = elements.node_of(cut, change.lane.copies[k]);
    if (kind_ != MassKind::consistent) return element;
    const double whole = whole_mass(cut, change.element);
    const auto shares = corner_mass_matrix(kind_, change.lane.moments);
    for (std::size_t pair = 0; pair < 6; ++pair) {
        const auto& [i, j] = kernels::corner_pairs[pair];
        element.pair_masses[pair] = whole * shares[i][j];
    }
    return element;
}

}  // namespace lancet::runtime
