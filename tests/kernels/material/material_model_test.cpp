// Names of materials and tangents, and which belong together.
#include "lancet/kernels/material/material_model.hpp"

#include <array>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::kernels::test {
namespace {

constexpr std::array models{MaterialModel::linear, MaterialModel::corotational, MaterialModel::st_venant_kirchhoff};
constexpr std::array kinds{TangentKind::rotated, TangentKind::exact, TangentKind::projected};

TEST(MaterialModel, HasNames) {
    for (const MaterialModel model : models) EXPECT_EQ(material_model_from_string(to_string(model)), model);
    for (const TangentKind kind : kinds) EXPECT_EQ(tangent_kind_from_string(to_string(kind)), kind);
    EXPECT_EQ(to_string(MaterialModel::st_venant_kirchhoff), "st-venant-kirchhoff");
    EXPECT_THROW(material_model_from_string("rubber"), Error);
    EXPECT_THROW(tangent_kind_from_string("secant"), Error);
}

TEST(MaterialModel, RefusesATangentThatDoesNotExist) {
    for (const MaterialModel model : models) {
        for (const TangentKind kind : kinds) {
            if (model == MaterialModel::st_venant_kirchhoff && kind == TangentKind::rotated) {
                EXPECT_FALSE(has_tangent(model, kind));
                EXPECT_THROW(require_tangent(model, kind), Error);
            } else {
                EXPECT_TRUE(has_tangent(model, kind));
                EXPECT_NO_THROW(require_tangent(model, kind));
            }
        }
    }
}

}  // namespace
}  // namespace lancet::kernels::test
