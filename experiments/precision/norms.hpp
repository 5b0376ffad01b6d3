#pragma once

#include "lancet/experiments/precision/box_field.hpp"

namespace lancet::experiments::precision {

/// Norms of a displacement field, or of the difference of two.
struct Norms {
    double l2 = 0;      ///< sqrt(int |u|^2), m^(5/2)
    double energy = 0;  ///< sqrt(int sigma(u) : epsilon(u)), J^(1/2): twice the elastic energy, under the root
};

/// What energies are made of.
struct EnergyForm {
    double young_modulus = 1;  ///< Pa
    double poisson_ratio = 0;
    /// Strains are those of R^T grad u, with R the rotation of the reference solution: the second derivative of the
    /// corotational energy there, with the rotations held. Without: R = 1, the linear model.
    bool rotated = false;
};

/// Norms of `u` - `reference` (of the displacement alone without `u`), by quadrature on the elements of `reference`:
/// the rule of four points, exact to degree 2, for the L2 norm, and the centre of each element for the energy norm.
/// Exact where each element of `reference` lies in one element of `u`.
[[nodiscard]] Norms error_norms(const BoxField& u, const BoxField& reference, const EnergyForm& form);

/// L2 norm, and sqrt(2 W) for the elastic energy W of the displacement itself, linear or (rotated) corotational: what
/// errors are relative to.
[[nodiscard]] Norms norms(const BoxField& reference, const EnergyForm& form);

}  // namespace lancet::experiments::precision
