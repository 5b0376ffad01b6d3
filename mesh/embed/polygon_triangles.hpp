#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lancet/mesh/surface/triangle_mesh.hpp"

namespace lancet::mesh {

/// Divides a plane region into triangles on its corners, without further ones. Its loops are numbers of places:
/// counter-clockwise around the region as seen against the normal, clockwise around holes.
///
/// Whatever the places are, even where loops touch or cross, every side of a loop is a side of exactly one triangle in
/// the same direction, and all other sides come in opposite pairs: closed surfaces stay closed. Ears are cut off, the
/// best shaped first (Eberly 1998); time is cubic in the corners.
void add_triangles(std::span<const std::vector<std::int32_t>> loops, std::span<const Point> places, const Point& normal,
                   std::vector<Triangle>& triangles);

}  // namespace lancet::mesh
