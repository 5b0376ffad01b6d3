#pragma once

#include <span>
#include <string_view>

#include "lancet/mesh/tet_mesh.hpp"

/// What a node of a cut body carries, in three bases. The solver knows the substituted one only; the others are for
/// input, output and the study of critical steps.
///
/// A cut, with H = +1 on one of its sides and -1 on the other, splits the values around a node in two copies x+ and x-.
/// With u and the enriched unknown a of the basis function psi phi_i, a copy is u + psi a:
///
/// | basis       | psi           | x+        | x-        | u                              | a             |
/// |-------------|---------------|-----------|-----------|--------------------------------|---------------|
/// | substituted |               | x+        | x-        |                                |               |
/// | shifted     | (H - H_i) / 2 | u, or u+a | u-a, or u | the copy on the node's side    | x+ - x-       |
/// | heaviside   | H             | u + a     | u - a     | (x+ + x-) / 2                  | (x+ - x-) / 2 |
///
/// where H_i is the side of the node itself. So in the shifted basis u is the displacement of the node and a the
/// opening of the cut there; both hold for either H_i.
///
/// More than two copies come from one cut after another; each adds a level (Jerabkova 2007, section 3.1.1): it splits
/// one of the copies that there are, the same formulas with that copy's value in the place of u. The m copies of a node
/// are numbered in the order in which they came into being, copy k > 0 by level k - 1: `parent` is the copy it was
/// split from, and `side` the side H of the cut on which the parent stayed. The parent of a shifted level keeps its
/// value, so it should be chosen as the one that stays with the node; then u is the value of copy 0, at the node
/// itself.
///
/// Every level is a reversible change of two values, and the node's others are untouched: from copies to u, a_1, a_2,
/// ... the levels are undone last to first, back they are taken first to last.
namespace lancet::runtime {

enum class Enrichment { substituted, shifted, heaviside };
std::string_view to_string(Enrichment enrichment) noexcept;
/// Throws lancet::Error for a name that to_string does not give.
Enrichment enrichment_from_string(std::string_view name);

/// How copy k came into being, for level k - 1.
struct CopyLevel {
    int parent = 0;  ///< the copy that was split, below k
    int side = 1;    ///< H of the side on which the parent stayed: +1 or -1
};

/// The values of a node's copies become (u, a_1, ..., a_m-1), in place.
/// - levels: m - 1 of them
/// - values: m vectors of any unit
/// Throws lancet::Error if the sizes do not go together, a parent comes after its copy, or a side is not +1 or -1.
void copies_to_enriched(Enrichment enrichment, std::span<const CopyLevel> levels, std::span<mesh::Point> values);

/// The inverse: (u, a_1, ..., a_m-1) become the values of the copies, in place. Throws as copies_to_enriched does.
void enriched_to_copies(Enrichment enrichment, std::span<const CopyLevel> levels, std::span<mesh::Point> values);

}  // namespace lancet::runtime
