#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "lancet/kernels/layout/element_batches.hpp"
#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::runtime {

/// An isotropic elastic material.
struct Material {
    double young_modulus = 1e5;   ///< Pa, positive
    double poisson_ratio = 0.33;  ///< in (-1, 0.5)
    double density = 1000;        ///< kg / m^3, positive
};

/// The Lame parameters of a material. Throws lancet::Error for values outside the ranges above.
kernels::ElasticParameters elastic_parameters(const Material& material);

/// What is simulated: a body at rest, what it is made of, what holds and what pulls it.
struct Scene {
    mesh::TetMesh mesh;
    /// By region of the mesh; regions that are not named take the material of region 0, which must be there.
    std::map<int, Material> materials{{0, Material{}}};
    std::vector<std::int32_t> fixed_nodes;       ///< held for good: they leave the system of equations
    std::array<double, 3> gravity{0, -9.81, 0};  ///< m / s^2
    double rayleigh_mass = 0;                    ///< D = rayleigh_mass M + rayleigh_stiffness K; 1 / s
    double rayleigh_stiffness = 0;               ///< s
};

}  // namespace lancet::runtime
