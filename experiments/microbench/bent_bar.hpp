#pragma once

#include <array>
#include <vector>

#include "lancet/kernels/layout/aligned_vector.hpp"
#include "lancet/kernels/layout/node_numbering.hpp"
#include "lancet/mesh/tet_mesh.hpp"
#include "lancet/runtime/simulate/scene.hpp"

namespace lancet::experiments {

/// The Bar in motion: clamped at x = 0, bent by one radian and twisted, in two states one time step apart, so that
/// rotations that follow it start as near to the solution as they do in a simulation. All nodal vectors are xyz_ in the
/// internal numbering.
struct BentBar {
    static constexpr double time_step = 0.04;  ///< s
    static constexpr runtime::Material material{.young_modulus = 1e5, .poisson_ratio = 0.33, .density = 100};

    mesh::TetMesh mesh;
    kernels::NodeNumbering numbering;
    std::vector<double> nodal_mass;                        ///< kg, [node], internal numbering
    kernels::AlignedVector<double> rest;                   ///< m
    std::array<kernels::AlignedVector<double>, 2> states;  ///< m, earlier and later
    std::array<kernels::AlignedVector<double>, 6> random;  ///< standard normal, exact in float; zero at fixed nodes

    int elements() const { return static_cast<int>(mesh.tetrahedra().size()); }
};

/// The Bar with `cells` along its axes, five elements each.
BentBar make_bent_bar(const std::array<int, 3>& cells);

}  // namespace lancet::experiments
