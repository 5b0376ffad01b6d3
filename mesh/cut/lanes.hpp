#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "lancet/mesh/cut/cut_mesh.hpp"

namespace lancet::mesh {

/// How what lies around the front of a cut, the border along which it ends inside of the body, is discretised.
enum class Fronts {
    sharp,   ///< parts as they are: a node has copies only where everything around it is separated
    blended  ///< copies fade in while the front passes by (see below)
};
std::string_view to_string(Fronts fronts) noexcept;

/// The elements with which a cut mesh is computed: tetrahedra on copies of nodes, of which only a part is there.
///
/// Sharp fronts. Each part is a lane; parts of one element that have the same copies at all corners are one.
///
/// Blended fronts. A sharp front moves from node to node: as long as anything around a node is not cut through, the
/// node is closed, and the body too stiff by up to the length of an element; then it jumps. Instead, let c be a copy in
/// which two sides of a cut meet, and go on with the cut's plane through all elements around it. Of int phi_c over
/// these sections, the share o_c in [0, 1] is cut, and is how far the copy is open. With a further copy c' for the far
/// side, an element's energy is the mean over the thresholds t in [0, 1] of what it would be if exactly the copies with
/// o_c > t were open,
///
///     W = int_0^1 sum_p v_p(t) W(F_p(t)) dt,
///
/// which is a sum over lanes, at most two for each different o_c in the element: weights add up to one, so mass, free
/// fall and the patch test are exact; the energy is continuous as the front moves, and nothing is left of the blend
/// where the front has passed (all o_c = 1) or not arrived (all o_c = 0).
struct Lanes {
    struct Lane {
        std::int32_t element;
        Tetrahedron copies;
        PartMoments moments;
    };
    std::vector<Lane> lanes;                 ///< lane e is of element e, as far as there are elements
    std::vector<std::int32_t> node_of_copy;  ///< those of the cut mesh, then those that are opening
    std::vector<std::int32_t> opened_from;   ///< the copies from which the last ones open, in their order
};

Lanes lanes(const CutMesh& cut, Fronts fronts = Fronts::sharp);

/// Takes lanes that have less than `floor` of their element as if they had so much of it: all their moments grow in
/// proportion, so that centres stay. Stiffness and mass are then no smaller than `floor` of an element's, which methods
/// without a preconditioner for thin parts need; it is an error, for up to `floor` of an element is there twice. Here
/// nothing needs it: thin parts are solved as well as others. Throws lancet::Error for a floor outside of [0, 1).
void raise_fractions(Lanes& lanes, double floor);

}  // namespace lancet::mesh
