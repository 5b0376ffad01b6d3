#include "lancet/experiments/stability/settings.hpp"

#include <utility>

#include "lancet/runtime/simulate/body.hpp"

namespace lancet::experiments::stability {

using kernels::TangentKind;
using runtime::ElementModel;
using runtime::MassKind;
using runtime::OperatorKind;
using runtime::ScalarMode;

namespace {

/// The elements of a scene, each with nodes of its own that nothing holds.
runtime::Scene taken_apart(const runtime::Scene& scene) {
    runtime::Scene apart;
    apart.materials = scene.materials;
    mesh::TetMesh::Definition definition;
    definition.regions.assign(scene.mesh.regions().begin(), scene.mesh.regions().end());
    for (mesh::Tetrahedron corners : scene.mesh.tetrahedra()) {
        for (std::int32_t& corner : corners) {
            definition.nodes.push_back(scene.mesh.nodes()[static_cast<std::size_t>(corner)]);
            corner = static_cast<std::int32_t>(definition.nodes.size()) - 1;
        }
        definition.tetrahedra.push_back(corners);
    }
    apart.mesh = mesh::TetMesh(std::move(definition));
    return apart;
}

}  // namespace

runtime::Settings settings_of(const Variant& variant, const runtime::Scene& uncut, runtime::Scheduler& scheduler,
                              double time_step) {
    runtime::Settings settings;
    settings.time_step = time_step;
    settings.model = variant.model;
    settings.tangent =
        variant.model == ElementModel::st_venant_kirchhoff ? TangentKind::projected : TangentKind::rotated;
    settings.mass = variant.mass;
    settings.scalar = variant.scalar;
    settings.matrix = variant.matrix;
    settings.preconditioner = variant.preconditioner;
    if (!variant.is_explicit()) return settings;
    settings.integrator = runtime::Integrator::central_differences;
    settings.energy_safeguard = false;
    settings.force_time_step = true;
    settings.time_step = 0.95 * make_body(variant.stepping == Stepping::explicit_element ? taken_apart(uncut) : uncut,
                                          settings, scheduler)
                                    ->critical_time_step(scheduler);
    settings.force_time_step = false;
    return settings;
}

runtime::EquilibriumSettings equilibrium_settings_of(const Variant& variant) {
    runtime::EquilibriumSettings settings;
    settings.model = variant.model;
    settings.tangent = variant.model == ElementModel::linear ? TangentKind::rotated : TangentKind::exact;
    settings.scalar = variant.scalar;
    settings.matrix = variant.matrix;
    settings.preconditioner = variant.preconditioner;
    // All in float, the residual ends where rounding of the forces begins.
    settings.tolerance = variant.scalar == ScalarMode::single_precision ? 1e-4 : 1e-8;
    return settings;
}

std::vector<Variant> all_dynamics() {
    std::vector<Variant> variants;
    for (const ElementModel model :
         {ElementModel::corotational, ElementModel::linear, ElementModel::st_venant_kirchhoff}) {
        for (const ScalarMode scalar : {ScalarMode::single_precision, ScalarMode::double_precision}) {
            for (const OperatorKind matrix :
                 {OperatorKind::edge_blocks, OperatorKind::block_rows, OperatorKind::matrix_free}) {
                for (const MassKind mass : {MassKind::lumped, MassKind::fraction}) {
                    variants.push_back({.mass = mass, .model = model, .scalar = scalar, .matrix = matrix});
                }
            }
            for (const Stepping stepping : {Stepping::explicit_element, Stepping::explicit_assembled}) {
                variants.push_back({.mass = MassKind::fraction,
                                    .model = model,
                                    .scalar = scalar,
                                    .stepping = stepping,
                                    .is_promised = stepping == Stepping::explicit_element &&
                                                   model != ElementModel::st_venant_kirchhoff});
            }
        }
    }
    return variants;
}

std::vector<Variant> with_both_fronts(const std::vector<Variant>& variants) {
    std::vector<Variant> both;
    for (Variant variant : variants) {
        for (const mesh::Fronts fronts : {mesh::Fronts::sharp, mesh::Fronts::blended}) {
            variant.fronts = fronts;
            both.push_back(variant);
        }
    }
    return both;
}

}  // namespace lancet::experiments::stability
