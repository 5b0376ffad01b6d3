#include "lancet/runtime/simulate/scene.hpp"

#include <cmath>
#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {

kernels::ElasticParameters elastic_parameters(const Material& material) {
    const auto [young, poisson, density] = material;
    if (!(young > 0) || !std::isfinite(young)) {
        throw Error("material: Young's modulus is " + std::to_string(young) + " Pa; expected a positive number");
    }
    if (!(poisson > -1 && poisson < 0.5)) {
        throw Error("material: Poisson's ratio is " + std::to_string(poisson) +
                    "; expected more than -1 and less than 0.5");
    }
    if (!(density > 0) || !std::isfinite(density)) {
        throw Error("material: density is " + std::to_string(density) + " kg/m^3; expected a positive number");
    }
    return {.lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson)),
            .mu = young / (2 * (1 + poisson)),
            .density = density};
}

}  // namespace lancet::runtime
