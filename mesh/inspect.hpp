#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh {

/// What the nodes of a tetrahedron span.
enum class Shape { positive, flat, inverted };

/// Decides whether a tetrahedron is flat from rounding alone, at every scale.
///
/// The coordinates are rounded numbers: moving each by one unit in its last place, at most eps M with M the largest
/// absolute coordinate and eps = 2^-52, changes 6 V by up to about eps M S, S being twice the sum of the face areas;
/// evaluating the determinant adds a few eps |e1| |e2| |e3| (e: edges from the first node). A tetrahedron is flat
/// where |6 V| <= 4 eps (M S + |e1| |e2| |e3|), that is, where rounding could have chosen the sign of its volume, and
/// where its volume overflows or underflows double precision.
Shape shape(const Point& a, const Point& b, const Point& c, const Point& d);

/// Everything that is wrong with a definition. Elements whose nodes are out of range, repeated or not finite are
/// not looked at further.
struct Inspection {
    std::vector<std::int32_t> non_finite_nodes;
    std::vector<std::int32_t> out_of_range_elements;
    std::vector<std::int32_t> repeated_node_elements;
    std::vector<std::int32_t> inverted_elements;
    std::vector<std::int32_t> flat_elements;
    /// The later copies of elements that have the same four nodes.
    std::vector<std::int32_t> duplicate_elements;
    /// Nodes that no element uses.
    std::vector<std::int32_t> isolated_nodes;
    /// Sizes that do not fit together, sets out of range, more nodes or elements than 32-bit numbers count.
    std::vector<std::string> other;
    /// Lowest volume among inverted and flat elements, and where it is.
    double worst_volume = 0;
    std::int32_t worst_element = -1;

    bool clean() const;
};

/// Looks for everything TetMesh refuses. Time and memory are linear in the size of the definition.
Inspection inspect(const TetMesh::Definition& definition);

/// One line: what was found, how many, the first place of each kind and the worst volume.
std::string describe(const Inspection& inspection, const TetMesh::Definition& definition);

}  // namespace lancet::mesh
