#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "lancet/mesh/io/cursor.hpp"
#include "lancet/mesh/surface/triangle_mesh.hpp"

namespace lancet::mesh::io {

TriangleMesh read_obj(Cursor& file);
TriangleMesh read_stl(Cursor& file);
TriangleMesh read_ply(Cursor& file);

/// Adds a polygon as a fan from its first corner. Corners are numbers of vertices, not yet checked.
void add_polygon(TriangleMesh& surface, std::span<const std::int32_t> corners);

/// A copy in which vertices in exactly the same place are one: the first of them.
TriangleMesh merged(const TriangleMesh& surface);

}  // namespace lancet::mesh::io
