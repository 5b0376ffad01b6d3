#pragma once

#include <string>
#include <vector>

#include "lancet/mesh/io/read.hpp"

namespace lancet::mesh::test {

/// A small valid file.
struct Sample {
    std::string name;
    MeshFormat format;
    std::string content;
    /// The .ele part of TetGen.
    std::string second;
};

/// One sample for each variant of each format. All hold the same mesh: two tetrahedra 0 1 2 3 and 1 2 3 4 of regions 3
/// and 7 on five nodes, the last of them at (1, 1, 1.25).
std::vector<Sample> samples();

}  // namespace lancet::mesh::test
