#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "lancet/mesh/cut/part_moments.hpp"
#include "lancet/mesh/cut/plane_pool.hpp"
#include "lancet/mesh/cut/polygon.hpp"

namespace lancet::mesh {

/// A convex polyhedron in a tetrahedron. Its edges lie in exactly two of its faces, and no two faces in one plane.
struct Cell {
    struct Face {
        HalfSpace half;         ///< the plane of the face, and on which side of it the cell is
        PointNumbers points{};  ///< counter-clockwise as seen from outside
        HalfSpaces edges{};     ///< of the other face at the edge from each point to the next
        operator PolygonView() const { return {half.plane, points, edges}; }
    };
    std::vector<Face> faces{};
};

/// On which side of one plane the points of a pool lie, asked for once each.
class PointSides {
  public:
    PointSides(const PlanePool& pool, int plane) : pool_(&pool), plane_(plane) {}

    int plane() const noexcept { return plane_; }
    int of(int point) {
        const auto at = static_cast<std::size_t>(point);
        return at < known_.size() && known_[at] != unknown ? known_[at] : find(point);
    }
    /// The lowest and the highest side of the points of a cell.
    std::array<int, 2> range(const Cell& cell);
    std::array<int, 2> range(std::span<const int> points);
    /// True where some of the cell lies on the positive side.
    bool has_above(const Cell& cell);
    /// Of points that have been taken back nothing is known.
    void keep_points(int count);

  private:
    int find(int point);

    static constexpr std::int8_t unknown = 2;
    const PlanePool* pool_;
    int plane_;
    std::vector<std::int8_t> known_;
};

/// A point in which a plane crosses the edge between two points.
struct Crossing {
    int low = 0, high = 0;
    int point = 0;
};
using Crossings = InlineVector<Crossing, 16>;

/// The tetrahedron itself; adds its corners to the pool as points 0 to 3.
Cell whole_tetrahedron(PlanePool& pool);

/// The pieces of a cell on the negative and on the positive side of a plane; nothing where the plane does not go
/// through its inside. The last face of each is that in the plane.
std::optional<std::pair<Cell, Cell>> split(PlanePool& pool, const Cell& cell, int plane);
/// The same; of edges that are among `crossings` the points are taken from there, others are added.
std::optional<std::pair<Cell, Cell>> split(PlanePool& pool, const Cell& cell, PointSides& sides, Crossings& crossings);
/// The corners of the section in which a plane meets a cell that it crosses, in no order.
PointNumbers section_points(PlanePool& pool, const Cell& cell, PointSides& sides, Crossings& crossings);

/// True where a face of the cell lies in the plane.
bool has_face_in(const Cell& cell, PointSides& sides);

/// A face as a polygon that can be clipped.
Polygon polygon(const Cell& cell, std::size_t face);

/// Adds the cell's integrals.
void add_cell(PartMoments& moments, const PlanePool& pool, const Cell& cell);

}  // namespace lancet::mesh
