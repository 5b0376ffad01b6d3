#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh {

struct ReadOptions {
    /// Coordinates are multiplied by this.
    double scale = 1;
    /// Turn inverted elements and drop nodes that no element uses (see repair.hpp); off: such files are refused.
    bool repair = true;
    /// With repair: drop flat elements and those with a repeated node, too.
    bool drop_flat = false;
    /// With repair: drop later copies of an element, too.
    bool drop_duplicates = false;
};

struct ReadResult {
    TetMesh mesh;
    /// What was skipped or repaired, one readable line each; empty if the mesh is the file's content as it stands.
    std::vector<std::string> notes;
};

enum class MeshFormat {
    gmsh,        ///< .msh: versions 1, 2 to 2.2 and 4.1; ASCII, and binary in either byte order
    vtk_legacy,  ///< .vtk: unstructured grids, ASCII or binary
    vtk_xml,     ///< .vtu: ascii, base64, raw appended; uncompressed or zlib; either byte order
    tetgen,      ///< .node and .ele beside each other
    abaqus       ///< .inp: nodes, C3D4 elements, node and element sets
};

/// Reads a mesh of linear tetrahedra. The format follows from the content where that is distinctive (Gmsh, VTK), and
/// from the extension otherwise. For TetGen, name either file.
///
/// Cells of lower dimension are skipped with a note; nodes of their physical groups become node sets (Gmsh). Regions
/// come from physical groups (Gmsh), the cell array region, material, MaterialIds, CellEntityIds, gmsh:physical or
/// medit:ref (VTK), the first attribute (TetGen) or element sets (Abaqus).
/// @throws lancet::Error that names the file, the line or byte, and what was expected.
ReadResult read(const std::filesystem::path& path, const ReadOptions& options = {});

/// Reads from memory. `name` stands for the file in messages; `second` is the .ele part of TetGen, empty otherwise.
ReadResult read_from_memory(MeshFormat format, std::string_view content, std::string_view second = {},
                            const std::string& name = "memory", const ReadOptions& options = {});

}  // namespace lancet::mesh
