#pragma once

#include <span>

#include "lancet/mesh/surface/box_grid.hpp"
#include "lancet/mesh/surface/triangle_mesh.hpp"

namespace lancet::mesh {

/// Whether places lie inside of a closed surface.
///
/// The crossings of a ray along each axis are counted; where the three parities disagree, for a ray through an edge
/// rounding may miss or double, the winding number decides: the sum of the solid angles of all triangles over 4 pi, by
/// van Oosterom and Strackee (1983). Places within rounding of the surface itself are on either side.
class InsideTest {
  public:
    /// Copies the surface. @throws lancet::Error for one that is not closed, or not valid.
    explicit InsideTest(const TriangleMesh& surface);

    bool contains(const Point& place) const;
    /// How often the surface goes around the place: 1 inside and 0 outside of a simple one that is counter-clockwise as
    /// seen from outside. Takes time linear in the surface.
    double winding_number(const Point& place) const;

  private:
    bool is_odd(const Point& place, std::size_t axis) const;

    TriangleMesh surface_;
    BoxGrid grid_;
};

}  // namespace lancet::mesh
