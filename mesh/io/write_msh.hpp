#pragma once

#include <filesystem>

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh {

enum class MshVersion { v2_2, v4_1 };

struct MshOptions {
    MshVersion version = MshVersion::v4_1;
    /// Numbers as they lie in memory instead of text that reads back to the same value.
    bool binary = true;
};

/// Writes Gmsh's format. Regions become physical volumes (region 0 is none), node sets become physical points: one
/// point element per member, numbered 1, 2, ... in the order of their names. The order of nodes and elements is kept.
/// @throws lancet::Error for negative regions and names with a quote, which the format cannot hold, and where the file
/// cannot be written.
void write_msh(const std::filesystem::path& path, const TetMesh& mesh, const MshOptions& options = {});

}  // namespace lancet::mesh
