#pragma once

#include <string_view>

namespace lancet::kernels {

/// The isotropic materials; all have two Lame parameters, and all are Hooke's law at small strains and rotations.
enum class MaterialModel {
    linear,              ///< LinearMaterial: small strain
    corotational,        ///< CorotationalMaterial: small strain in the frame of the rotation of F
    st_venant_kirchhoff  ///< StVenantKirchhoffMaterial: Green's strain
};

/// Which second derivative of the energy serves as stiffness.
enum class TangentKind {
    rotated,   ///< R K R^T, the rotation held fixed: positive semidefinite (linear, where R = 1, and corotational)
    exact,     ///< the derivative of the stress, perhaps indefinite
    projected  ///< the exact one with its negative eigenvalues set to zero
};

/// The name that options and tables use: linear, corotational, st-venant-kirchhoff.
std::string_view to_string(MaterialModel model) noexcept;
/// The inverse of to_string. Throws Error, naming the choices, for an unknown name.
MaterialModel material_model_from_string(std::string_view name);

/// The name that options and tables use: rotated, exact, projected.
std::string_view to_string(TangentKind kind) noexcept;
/// The inverse of to_string. Throws Error, naming the choices, for an unknown name.
TangentKind tangent_kind_from_string(std::string_view name);

/// True if the material has such a tangent: all but the rotated one of St. Venant and Kirchhoff's.
constexpr bool has_tangent(MaterialModel model, TangentKind kind) {
    return !(model == MaterialModel::st_venant_kirchhoff && kind == TangentKind::rotated);
}
/// Throws Error unless has_tangent.
void require_tangent(MaterialModel model, TangentKind kind);

}  // namespace lancet::kernels
