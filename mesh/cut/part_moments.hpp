#pragma once

#include <array>

namespace lancet::mesh {

/// Integrals of the shape functions lambda_i over a part of a tetrahedron, divided by the tetrahedron's volume:
///
///     fraction = 1/V int_part 1,   first_i = 1/V int_part lambda_i,   second_ij = 1/V int_part lambda_i lambda_j.
///
/// The lambda_i add up to one, so that sum_i first_i = fraction and sum_j second_ij = first_i. What is made by default
/// is the whole tetrahedron.
struct PartMoments {
    double fraction = 1;
    std::array<double, 4> first{0.25, 0.25, 0.25, 0.25};
    std::array<std::array<double, 4>, 4> second{
        {{0.1, 0.05, 0.05, 0.05}, {0.05, 0.1, 0.05, 0.05}, {0.05, 0.05, 0.1, 0.05}, {0.05, 0.05, 0.05, 0.1}}};

    bool operator==(const PartMoments&) const = default;
};

/// A point of a tetrahedron by its barycentric coordinates (lambda_0, ..., lambda_3), which add up to one.
using Barycentric = std::array<double, 4>;

/// The moments of nothing, to add to.
PartMoments empty_moments();

/// Adds a multiple of other moments.
void add_weighted(PartMoments& moments, const PartMoments& other, double weight);

/// Adds the tetrahedron spanned by four points; either orientation adds its volume.
///
/// The relative error is a few roundings where small coordinates carry the thickness, as in slivers next to a corner,
/// an edge or a face of the tetrahedron: they are not subtracted from large ones. A slice through the middle is known
/// only as well as the differences of its corners, to about 1e-16 over its thickness.
void add_tetrahedron(PartMoments& moments, const std::array<Barycentric, 4>& corners);
/// The same, where the volume over that of the whole is known.
void add_tetrahedron(PartMoments& moments, const std::array<Barycentric, 4>& corners, double fraction);

}  // namespace lancet::mesh
