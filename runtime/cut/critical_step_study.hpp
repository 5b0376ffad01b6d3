#pragma once

#include <string_view>
#include <vector>

#include "lancet/runtime/cut/enrichment.hpp"
#include "lancet/runtime/cut/study_element.hpp"

/// The critical time step of one cut element in every basis and lumping, by dense matrices: what choosing a basis and a
/// mass for explicit integration rests on. Not for simulation.
namespace lancet::runtime {

/// A cut of an element that is perhaps cut already: cut number k takes part k + 1 off what was part `from` <= k; `from`
/// lies on the side H = +1.
struct StudyCut {
    int from = 0;
};

/// An element cut through, with corners that no other element shares.
struct CutElement {
    StudyElement element;
    std::vector<StudyPart> parts;
    std::vector<StudyCut> cuts;     ///< one fewer than parts, in order
    std::vector<int> corner_parts;  ///< [corner]: the part the corner lies in
};

/// The mass of the study. Of the matrix <psi_i phi_i psi_j phi_j>, with <.> the mean over the element, lumpings take
/// each level of enrichment by itself, that is u, a_1, a_2, ... or, in the substituted basis, each part:
///
/// - enrichment: m_i = <psi_i^2> / n with n corners (Menouillard et al. 2006; Jerabkova 2007, eq. 3.46 for u, where psi
/// = 1,
///   and 3.47 for a). For the shifted enrichment of one cut this is 1/n for u and v_i / n for a, with v_i the fraction
///   of the side that node i is not on; for the Heaviside one 1/n for both. It is D, the diagonal of what fraction
///   lumping M becomes in the enriched basis, T^T M T; the coupling of u and a is left out. A semi-definite matrix of m
///   rows is at most m times its diagonal, so T^T M T <= (1 + cuts) D, and the ratio of critical steps is at least 1 /
///   sqrt(1 + cuts); for one shifted cut, where M_ua^2 = v_i M_uu M_aa, at least 1 / sqrt(1 + sqrt(max(v, 1 - v))).
/// - row_sum: m_i = sum_j <psi_i phi_i psi_j phi_j>.
/// - weighted_diagonal: m_i = s <psi_i^2 phi_i^2> with s such that a level has the mass of the element, a part its own.
/// - consistent: the matrix itself.
/// - fraction: v_p / n at each corner of part p; in an enriched basis the same mass, which is not diagonal there.
enum class StudyLumping { enrichment, row_sum, weighted_diagonal, consistent, fraction };
std::string_view to_string(StudyLumping lumping) noexcept;

/// Stiffness and mass of a cut element, [row][column]. Row = (corner * copies + level) * axes + axis, with levels u,
/// a_1, a_2, ... or, in the substituted basis, (corner * copies + part) * axes + axis.
struct StudyMatrices {
    int size = 0;
    std::vector<double> stiffness, mass;
};

/// Throws lancet::Error if the element's parts, cuts and corners do not go together.
StudyMatrices assemble(const CutElement& cut, Enrichment enrichment, StudyLumping lumping);

/// The change of basis: the copies of the corners, in the order of the substituted basis, from (u, a_1, ...), for one
/// axis; [row][column] with row = corner * copies + part and column = corner * copies + level.
std::vector<double> copies_of_enriched(const CutElement& cut, Enrichment enrichment);

/// The critical step of the cut element over that of the whole one with row sums: sqrt(omega_whole^2 / omega_cut^2),
/// the omega^2 being the largest eigenvalues of M^-1 K. Not a number if a mass is zero.
double critical_step_ratio(const CutElement& cut, Enrichment enrichment, StudyLumping lumping);

}  // namespace lancet::runtime
