#pragma once

#include <string_view>

namespace lancet::runtime {

/// The mass of a body: what it is lumped to, and how. For whole linear tetrahedra all but the last are the same, a
/// quarter of the element's mass at each corner; they differ for the parts of cut elements (see part_mass.hpp).
enum class MassKind {
    lumped,             ///< row sums of the consistent mass at each corner
    weighted_diagonal,  ///< its diagonal, scaled to the mass (Hinton, Rock, Zienkiewicz 1976)
    consistent,         ///< int rho phi_i phi_j
    /// The mass in equal shares at all corners: no cut brings the critical step below that of the worst whole element
    /// by itself (see part_mass.hpp).
    fraction
};
std::string_view to_string(MassKind kind) noexcept;
/// Throws lancet::Error for a name that to_string does not give.
MassKind mass_kind_from_string(std::string_view name);

}  // namespace lancet::runtime
