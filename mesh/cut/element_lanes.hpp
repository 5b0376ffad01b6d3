#pragma once

#include <cstdint>
#include <vector>

#include "lancet/mesh/cut/front_opening.hpp"
#include "lancet/mesh/cut/lanes.hpp"

namespace lancet::mesh {

/// The lanes of one element. `pieces` are what blended fronts make of it, nullptr where none is near.
std::vector<Lanes::Lane> lanes_of_element(const CutMesh& cut, std::int32_t element,
                                          const std::vector<FrontOpening::Piece>* pieces);

}  // namespace lancet::mesh
