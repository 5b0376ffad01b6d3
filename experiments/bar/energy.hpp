#pragma once

#include <span>
#include <vector>

#include "lancet/experiments/bar/problem.hpp"

namespace lancet::experiments::bar {

/// Parts of the mechanical energy in J.
struct Energy {
    double kinetic = 0;
    double elastic = 0;
    double gravitational = 0;  ///< zero at rest
    [[nodiscard]] double total() const { return kinetic + elastic + gravitational; }
};

/// Row-sum lumped nodal masses in kg: a quarter of each element's mass to each of its nodes.
[[nodiscard]] std::vector<double> lumped_masses(const Problem& problem);

/// The mechanical energy of a state; positions (m) and velocities (m/s) hold x, y, z of every node. The elastic part is
/// that of corotational linear elasticity, W = mu |F - R|^2 + lambda / 2 (tr(R^T F) - 3)^2 with R the rotation nearest
/// to F, here by the singular values of F, so that it shares nothing with the solvers that it judges. It is accurate to
/// about 1e-15 mu per unit of volume. Throws lancet::Error for arrays of another size.
[[nodiscard]] Energy energy(const Problem& problem, std::span<const double> positions,
                            std::span<const double> velocities);

}  // namespace lancet::experiments::bar
