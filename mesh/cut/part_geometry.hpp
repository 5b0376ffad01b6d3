#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/mesh/cut/front_blend.hpp"

namespace lancet::mesh {

/// A cut mesh as what can be drawn: the parts as tetrahedra, and the surface of all pieces, walls of cuts included.
/// Its points are points of the material, so that it can be drawn wherever the body moves, until the next cut.
struct PartGeometry {
    std::vector<MaterialPoint> points;
    std::vector<Tetrahedron> tetrahedra;  ///< of positive volume at rest; numbers of `points`
    std::vector<std::int32_t> part_of_tetrahedron;
    std::vector<Triangle> triangles;  ///< counter-clockwise as seen from outside of the piece
    std::vector<std::int32_t> part_of_triangle;
    std::vector<std::uint8_t> is_wall;  ///< [triangle] 1: a cut made it, 0: it is of the body's own surface

    /// A point beside a blended front: its place is that of `hold`.
    struct OpenedPoint {
        std::int32_t point;
        CopyWeights hold;
    };
    std::vector<OpenedPoint> opened;
};

/// At blended fronts, walls are where front_blend.hpp puts them: a wound that narrows, and is closed along the line
/// where its cuts end. The element with that line is drawn a little thinner or thicker than it is computed, for it is
/// computed as open right through.
PartGeometry part_geometry(const CutMesh& cut, const FrontBlend& blend = {});

/// Where the points are, with `positions` of all copies, and of those that open at blended fronts.
std::vector<Point> place(const PartGeometry& geometry, const CutMesh& cut, std::span<const Point> positions);

}  // namespace lancet::mesh
