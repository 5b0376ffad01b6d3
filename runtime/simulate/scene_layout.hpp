#pragma once

#include <vector>

#include "lancet/kernels/layout/element_batches.hpp"
#include "lancet/kernels/layout/node_numbering.hpp"
#include "lancet/mesh/order.hpp"
#include "lancet/runtime/simulate/scene.hpp"
#include "lancet/runtime/solve/operator.hpp"
#include "lancet/runtime/solve/preconditioner.hpp"

namespace lancet::runtime {

/// Throws lancet::Error for fixed nodes that do not exist, and for prescribed displacements of nodes or axes that do
/// not exist, without a function, or given twice.
void validate_constraints(const Scene& scene);

/// Throws lancet::Error where the parts are not as many as elements, or name moments that do not exist, or moments are
/// not positive and finite.
void validate_parts(const Scene& scene);

/// Throws lancet::Error for a scene with parts and no preconditioner: the stiffness of thin parts is as small as their
/// fraction, so that the iterations grow without bound and the residual hides their errors.
void require_preconditioner(const Scene& scene, PreconditionerKind kind);

/// The solver's numbering of a scene's nodes. Throws lancet::Error for fixed nodes that do not exist.
kernels::NodeNumbering number_scene(const Scene& scene, mesh::OrderingKind kind,
                                    const kernels::NumberingOptions& options);

/// The materials of a scene as one array, and for each element its place there.
struct ElementMaterials {
    std::vector<kernels::ElasticParameters> parameters;
    std::vector<std::int32_t> of_element;
    std::vector<double> fractions;  ///< how much of each element is there; empty: all
};

/// Throws lancet::Error if region 0 has no material, or the scene's parts do not go with its elements (see
/// validate_parts).
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
