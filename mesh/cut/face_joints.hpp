#pragma once

#include <array>
#include <functional>
#include <utility>
#include <vector>

#include "lancet/mesh/cut/element_cells.hpp"

namespace lancet::mesh {

/// A face as one of its two elements sees it.
struct FaceSide {
    const ElementCells* cells = nullptr;  ///< nothing where no cut touches the element
    int face = 0;                         ///< the corner opposite to it
    std::array<int, 3> corners{};         ///< its corners, in an order that both sides share
};

/// What a part has of a face.
struct FacePiece {
    int part = 0;  ///< its number within the element
    Polygon polygon{};
};

/// The pieces of the face on one side, in a pool in which the face is plane 3 with the corners 0, 1 and 2. Those of an
/// element with cells are counter-clockwise as seen from outside of it.
std::vector<FacePiece> face_pieces(PlanePool& pool, const FaceSide& side);

/// The pairs of parts (numbers within their elements) that share an open area of the face, among those for which
/// may_join(part of a, part of b) holds.
std::vector<std::pair<int, int>> joined_parts(const FaceSide& a, const FaceSide& b,
                                              const std::function<bool(int, int)>& may_join);

}  // namespace lancet::mesh
