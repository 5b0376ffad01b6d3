#pragma once

#include <vector>

#include "lancet/mesh/cut/element_cells.hpp"

namespace lancet::mesh {

/// What a part has of a face or an edge of its element: the integral of each shape function over its piece, divided by
/// the area of the face or the length of the edge.
struct BoundaryShare {
    int part = 0;  ///< number within the element
    std::array<double, 4> first{};
};

/// The shares of all parts of the face opposite a corner; they add up to 1/3 at each of its corners.
std::vector<BoundaryShare> face_shares(const ElementCells& cells, int corner);
/// The shares of all parts of the edge between two corners; they add up to 1/2 at each. Parts that meet in a piece of
/// the edge take equal shares of it.
std::vector<BoundaryShare> edge_shares(const ElementCells& cells, int first_corner, int second_corner);

}  // namespace lancet::mesh
