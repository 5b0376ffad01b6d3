#pragma once

#include <array>
#include <random>
#include <vector>

#include "lancet/kernels/layout/vertex_rings.hpp"

namespace lancet::kernels::test {

using Place = std::array<double, 3>;

/// A surface of triangles, of no particular kind.
struct Surface {
    std::vector<Place> places{};
    std::vector<Triangle> triangles{};
};

/// A closed one of `around` * `across` * 2 triangles, vertices moved off a torus by up to `roughness` of their
/// distances.
Surface rough_torus(int around, int across, double roughness, std::mt19937_64& random);
/// Triangles around the first vertex, in the plane z = 0, one for each angle (in radians) and one after the other.
Surface fan(const std::vector<double>& angles);

}  // namespace lancet::kernels::test
