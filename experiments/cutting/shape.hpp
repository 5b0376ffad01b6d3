#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lancet/mesh/cut/part_geometry.hpp"
#include "lancet/runtime/cut/cuttable_body.hpp"

namespace lancet::experiments::cutting {

/// What there is to see of a cut body at one time: its parts as tetrahedra, and their surface with the walls of cuts.
struct Shape {
    int step = 0;
    double time = 0;  ///< s
    std::vector<mesh::Point> points;
    mesh::PartGeometry geometry;
};

[[nodiscard]] Shape take_shape(int step, const runtime::CuttableBody& body);

}  // namespace lancet::experiments::cutting
