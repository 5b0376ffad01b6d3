#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "lancet/kernels/layout/element_batches.hpp"
#include "lancet/mesh/cut/part_moments.hpp"
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

/// A dead force on a node.
struct NodalLoad {
    std::int32_t node;
    std::array<double, 3> force;  ///< N
};

/// A dead force per length, uniform over the edge between two nodes at rest.
struct EdgeLoad {
    std::array<std::int32_t, 2> nodes;
    std::array<double, 3> force_per_length;  ///< N / m
};

/// A dead force per area, uniform over triangles of the boundary at rest.
struct Traction {
    std::vector<std::array<std::int32_t, 3>> triangles;
    std::array<double, 3> force_per_area;  ///< Pa
};

/// One component of a node's displacement as a function of time. Statics take it at time 0.
struct PrescribedDisplacement {
    std::int32_t node;
    int axis;                                    ///< 0, 1 or 2
    std::function<double(double)> displacement;  ///< metres from the position at rest, of the time in seconds
};

/// A rigid, frictionless half-space that nodes cannot enter.
struct Floor {
    std::array<double, 3> point;
    std::array<double, 3> normal;  ///< of unit length, out of the floor
};

/// Which elements of a scene's mesh are parts of cut ones: tetrahedra of which only a part is there.
struct ElementParts {
    std::vector<std::int32_t> place{};         ///< [element] its place in `moments`, -1 where it is whole; or empty
    std::vector<mesh::PartMoments> moments{};  ///< of what is there

    bool empty() const noexcept { return place.empty(); }
    mesh::PartMoments of(std::size_t element) const {
        return empty() || place[element] < 0 ? mesh::PartMoments{} : moments[static_cast<std::size_t>(place[element])];
    }
};

/// What is simulated: a body at rest, what it is made of, what holds and what pulls it.
struct Scene {
    mesh::TetMesh mesh;
    ElementParts parts{};  ///< of a scene with cuts; see divided_scene.hpp
    /// By region of the mesh; regions that are not named take the material of region 0, which must be there.
    std::map<int, Material> materials{{0, Material{}}};
    std::vector<std::int32_t> fixed_nodes;       ///< held for good: they leave the system of equations
    std::array<double, 3> gravity{0, -9.81, 0};  ///< m / s^2
    std::vector<NodalLoad> nodal_loads{};
    std::vector<EdgeLoad> edge_loads{};
    std::vector<Traction> tractions{};
    std::vector<PrescribedDisplacement> prescribed{};  ///< each component at most once, and not of fixed nodes
    std::optional<Floor> floor{};
    double rayleigh_mass = 0;       ///< D = rayleigh_mass M + rayleigh_stiffness K; 1 / s
    double rayleigh_stiffness = 0;  ///< s
};

}  // namespace lancet::runtime
