#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh {

/// One array of values per node or per element; the values are kept by reference.
struct VtuArray {
    std::string name;
    /// Values per node or element: 1 for scalars, 3 for vectors, one after the other.
    int components = 1;
    std::variant<std::span<const double>, std::span<const float>, std::span<const std::int32_t>> values;
};

/// What is written beside the mesh.
struct VtuContent {
    /// Where the nodes are; empty: where the mesh has them.
    std::span<const Point> positions{};
    std::vector<VtuArray> point_data{};
    std::vector<VtuArray> cell_data{};
};

/// Writes VTK's XML format with raw appended data, for ParaView: nodes in double, the cell array `region`, and each
/// node set as a point array `set:NAME` of 0 and 1, which read() understands. The file appears by renaming.
/// @throws lancet::Error for arrays of the wrong size or with a name twice, and where the file cannot be written.
void write_vtu(const std::filesystem::path& path, const TetMesh& mesh, const VtuContent& content = {});

/// Points with tetrahedra and triangles, of any shape and not checked.
struct VtuGrid {
    std::span<const Point> points{};
    std::span<const Tetrahedron> tetrahedra{};
    std::span<const Triangle> triangles{};
};

/// The same for what is to be looked at rather than computed with, such as the parts of a cut mesh: cell data are those
/// of the tetrahedra, then of the triangles; positions are the grid's.
void write_vtu(const std::filesystem::path& path, const VtuGrid& grid, const VtuContent& content);

}  // namespace lancet::mesh
