#pragma once

#include <array>

#include "lancet/mesh/cut/part_moments.hpp"
#include "lancet/runtime/solve/mass_kind.hpp"

/// The mass of the parts of cut tetrahedra in the substituted basis, where each part is an element with corners of its
/// own: all is per kilogram of the whole tetrahedron, v_p the part's volume fraction and <.> = 1/V int_part.
///
/// | kind              | at corner i                          | of the part it keeps             |
/// |-------------------|--------------------------------------|----------------------------------|
/// | fraction          | v_p / 4                              | the mass                         |
/// | lumped            | <phi_i>                              | the mass and its centre          |
/// | weighted_diagonal | v_p <phi_i^2> / sum_j <phi_j^2>      | the mass                         |
/// | consistent        | <phi_i phi_j>                        | the mass, its centre and inertia |
///
/// Fraction lumping is for explicit integration: no cut brings the critical step below the elements' own. Let K_e and
/// M_e be the stiffness and the lumped mass of a whole element e. A part p of it has v_p K_e and v_p M_e, on its own
/// copies of the nodes. For any motion u, with u_p its values at the corners of p and omega_e^2 the largest eigenvalue
/// of (K_e, M_e),
///
///     u^T K u = sum_p v_p u_p^T K_e u_p <= sum_p v_p omega_e^2 u_p^T M_e u_p <= max_e omega_e^2 u^T M u,
///
/// which is the bound by elements that holds before the cut, however many parts there are and however thin they are.
/// (The largest eigenvalue itself lies below this bound where elements share nodes; parts that are cut free of their
/// neighbours come up to it.) An element cut through, with no neighbours, has the eigenvalues of the whole one exactly.
/// The other kinds weigh the corners that a thin part does not reach with higher powers of its thickness than its
/// stiffness has: their critical step goes to zero with it.
///
/// Row sums are for implicit integration and for loads: gravity on a part acts through its centre of mass.
namespace lancet::runtime {

/// The mass of a part at each corner, in kg per kg of the whole tetrahedron; of a consistent mass, the row sums.
/// They are not negative and add up to the fraction. A part without volume has no mass.
std::array<double, 4> corner_masses(MassKind kind, const mesh::PartMoments& part);

/// The mass matrix of a part, for one axis, in kg per kg of the whole tetrahedron: diagonal but for the consistent
/// mass.
std::array<std::array<double, 4>, 4> corner_mass_matrix(MassKind kind, const mesh::PartMoments& part);

}  // namespace lancet::runtime
