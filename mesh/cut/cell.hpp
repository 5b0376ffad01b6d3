#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "lancet/mesh/cut/part_moments.hpp"
#include "lancet/mesh/cut/plane_pool.hpp"
#include "lancet/mesh/cut/polygon.hpp"

namespace lancet::mesh {

/// A convex polyhedron in a tetrahedron. Its edges lie in exactly two of its faces, and no two faces in one plane.
struct Cell {
    struct Face {
        HalfSpace half;             ///< the plane of the face, and on which side of it the cell is
        std::vector<int> points{};  ///< counter-clockwise as seen from outside
    };
    std::vector<Face> faces{};
};

/// The tetrahedron itself; adds its corners to the pool.
Cell whole_tetrahedron(PlanePool& pool);

/// The pieces of a cell on the negative and on the positive side of a plane; nothing where the plane does not go
/// through its inside. The last face of each is that in the plane.
std::optional<std::pair<Cell, Cell>> split(PlanePool& pool, const Cell& cell, int plane);

/// True where the plane goes through the inside of the cell.
bool is_crossed(const PlanePool& pool, const Cell& cell, int plane);
/// True where some of the cell lies on the positive side of the plane.
bool reaches_above(const PlanePool& pool, const Cell& cell, int plane);
/// True where a face of the cell lies in the plane.
bool has_face_in(const PlanePool& pool, const Cell& cell, int plane);

/// A face as a polygon that can be clipped.
Polygon polygon(const Cell& cell, std::size_t face);

/// Adds the cell's integrals.
void add_cell(PartMoments& moments, const PlanePool& pool, const Cell& cell);

}  // namespace lancet::mesh
