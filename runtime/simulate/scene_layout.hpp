#pragma once

#include <vector>

#include "lancet/kernels/layout/element_batches.hpp"
#include "lancet/kernels/layout/node_numbering.hpp"
#include "lancet/mesh/order.hpp"
#include "lancet/runtime/simulate/scene.hpp"
#include "lancet/runtime/solve/operator.hpp"

namespace lancet::runtime {

/// Throws lancet::Error for fixed nodes that do not exist, and for prescribed displacements of nodes or axes that do
/// not exist, without a function, or given twice.
void validate_constraints(const Scene& scene);

/// The solver's numbering of a scene's nodes. Throws lancet::Error for fixed nodes that do not exist.
kernels::NodeNumbering number_scene(const Scene& scene, mesh::OrderingKind kind,
                                    const kernels::NumberingOptions& options);

/// The materials of a scene as one array, and for each element its place there.
struct ElementMaterials {
    std::vector<kernels::ElasticParameters> parameters;
    std::vector<std::int32_t> of_element;
    std::vector<double> fractions;  ///< how much of each element is there; empty: all
};

/// Throws lancet::Error if region 0 has no material.
ElementMaterials element_materials(const Scene& scene);

/// Nodal masses, [internal node], in kilograms: see corner_masses.
std::vector<double> nodal_masses(const Scene& scene, const ElementMaterials& materials,
                                 const kernels::NodeNumbering& numbering, MassKind kind = MassKind::lumped);

/// The elements of a scene laid out for a kernel's width; with the masses of pairs where the mass is consistent.
template <class Real>
kernels::ElementBatches<Real> element_batches(const Scene& scene, const kernels::NodeNumbering& numbering,
                                              kernels::ScatterStrategy scatter, int width,
                                              MassKind mass = MassKind::lumped);

}  // namespace lancet::runtime
