#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lancet/mesh/cut/cut_mesh.hpp"

namespace lancet::mesh {

/// A region by its loops of vertices.
struct PartRegion {
    std::int32_t part = -1;      ///< in which it lies; -1: in several that are joined
    std::int32_t triangle = -1;  ///< of the surface; -1: a wall
    std::vector<std::vector<std::int32_t>> loops{};
};

/// Makes neighbouring regions meet corner to corner: where a side of a region is not that of another one, as seen from
/// the other side, the corners of other such sides that lie on it become its own. `points` are those of all vertices,
/// and `at_rest` their places.
void mend_loops(const CutMesh& cut, std::span<const MaterialPoint> points, std::span<const Point> at_rest,
                std::vector<PartRegion>& regions);

/// Takes repeated corners, and sides that run there and straight back, out of a loop; nothing may be left.
void simplify(std::vector<std::int32_t>& loop);

}  // namespace lancet::mesh
