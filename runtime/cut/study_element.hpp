#pragma once

#include <array>
#include <vector>

#include "lancet/mesh/cut/part_moments.hpp"
#include "lancet/mesh/tet_mesh.hpp"

/// Single elements and their parts, for the study of critical steps.
namespace lancet::runtime {

/// A linear element: a bar of two corners with one axis, or a tetrahedron of four with three. Its mass is 1 kg.
struct StudyElement {
    int corners = 0;
    int axes = 0;
    std::vector<double> stiffness;  ///< [row][column], N/m; row = corner * axes + axis
};

/// A bar of length 1 m, cross-section 1 m^2 and E = 1 Pa.
StudyElement study_bar();

/// Linear elasticity with E = 1 Pa. Throws lancet::Error for a tetrahedron without volume and for nu outside (-1, 1/2).
StudyElement study_tetrahedron(const std::array<mesh::Point, 4>& corners, double poisson_ratio);

/// Moments of a part of an element: those of PartMoments, for any number of corners.
struct StudyPart {
    double fraction = 0;
    std::vector<double> first;   ///< [corner]
    std::vector<double> second;  ///< [corner][corner]
};

StudyPart study_part(const mesh::PartMoments& moments);

/// The two parts of a bar cut at `cut` in (0, 1), that of corner 0 first.
std::array<StudyPart, 2> cut_bar(double cut);

/// The two parts of a tetrahedron cut parallel to the face opposite node 0: first that of node 0, with `fraction` in
/// (0, 1) of the volume.
std::array<mesh::PartMoments, 2> cut_off_corner(double fraction);

/// The two parts of a tetrahedron cut parallel to the edges 0 1 and 2 3: first that of nodes 0 and 1, with `fraction`
/// in (0, 1) of the volume.
std::array<mesh::PartMoments, 2> cut_off_edge(double fraction);

}  // namespace lancet::runtime
