#pragma once

#include <span>
#include <vector>

#include "lancet/runtime/schedule/scheduler.hpp"
#include "lancet/runtime/solve/lanczos.hpp"
#include "lancet/runtime/solve/operator.hpp"

namespace lancet::runtime {

/// The longest stable step of central differences, in seconds, for the largest eigenvalue omega^2 of M^-1 K (1 / s^2)
/// and Rayleigh damping alpha M + beta K: 2 / omega (sqrt(1 + xi^2) - xi), xi = (alpha / omega + beta omega) / 2 the
/// damping ratio of that mode (Jerabkova 2007, eq. 2.39). Infinite for eigenvalues that are not positive.
/// Throws lancet::Error for negative damping or numbers that are not finite.
double critical_step(double largest_eigenvalue, double rayleigh_mass = 0, double rayleigh_stiffness = 0);

/// The largest eigenvalue of M^-1 K over the free nodes, for a lumped M, in 1 / s^2: Lanczos on M^-1/2 K M^-1/2 from a
/// start that is random, but the same each time. The bound allows for the rounding of the products.
/// - stiffness: assembled with factors 0 of the mass and 1 of the stiffness
/// - nodal_mass: [internal node], kilograms; nodes without mass are left out
template <class Real>
LargestEigenvalue largest_eigenvalue(Scheduler& scheduler, Operator<Real>& stiffness,
                                     const kernels::NodeNumbering& numbering, const std::vector<double>& nodal_mass,
                                     double tolerance = LanczosSettings{}.tolerance);

}  // namespace lancet::runtime
