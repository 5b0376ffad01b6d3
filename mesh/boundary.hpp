#pragma once

#include <cstdint>
#include <vector>

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh {

/// The surface of a mesh: the faces that belong to exactly one element.
struct Boundary {
    /// Counter-clockwise as seen from outside: the right-handed normal points outward.
    std::vector<Triangle> triangles;
    /// The element behind each triangle.
    std::vector<std::int32_t> elements;
    /// Faces of three and more elements. They do not occur in a conforming mesh, and are not part of the surface.
    std::int64_t overused_faces = 0;
};

/// The surface, in the order of the elements.
Boundary boundary(const TetMesh& mesh);

}  // namespace lancet::mesh
