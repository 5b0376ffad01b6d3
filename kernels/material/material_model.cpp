#include "lancet/kernels/material/material_model.hpp"

#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::kernels {

std::string_view to_string(MaterialModel model) noexcept {
    switch (model) {
        case MaterialModel::linear:
            return "linear";
        case MaterialModel::corotational:
            return "corotational";
        default:
            return "st-venant-kirchhoff";
    }
}

MaterialModel material_model_from_string(std::string_view name) {
    for (const auto model : {MaterialModel::linear, MaterialModel::corotational, MaterialModel::st_venant_kirchhoff}) {
        if (to_string(model) == name) return model;
    }
    throw Error("unknown material '" + std::string(name) + "'; expected linear, corotational or st-venant-kirchhoff");
}

std::string_view to_string(TangentKind kind) noexcept {
    switch (kind) {
        case TangentKind::rotated:
            return "rotated";
        case TangentKind::exact:
            return "exact";
        default:
            return "projected";
    }
}

TangentKind tangent_kind_from_string(std::string_view name) {
    for (const auto kind : {TangentKind::rotated, TangentKind::exact, TangentKind::projected}) {
        if (to_string(kind) == name) return kind;
    }
    throw Error("unknown tangent '" + std::string(name) + "'; expected rotated, exact or projected");
}

void require_tangent(MaterialModel model, TangentKind kind) {
    if (has_tangent(model, kind)) return;
    throw Error("the material " + std::string(to_string(model)) + " has no " + std::string(to_string(kind)) +
                " tangent; expected exact or projected");
}

}  // namespace lancet::kernels
