#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lancet/mesh/io/cursor.hpp"
#include "lancet/mesh/io/read.hpp"
#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh::io {

/// What a reader found, before repair and validation.
struct RawMesh {
    TetMesh::Definition definition{};
    std::vector<std::string> notes{};
};

/// Scales, repairs and validates. Failures name the file.
ReadResult finish(RawMesh raw, const std::string& name, const ReadOptions& options);

/// A kind of cell that a format knows.
struct CellKind {
    const char* name;
    int dimension;
    /// Nodes of a cell; 0 where each cell has its own number.
    int nodes;
};

/// Counts the cells that are not tetrahedra.
class OtherCells {
  public:
    void add(const CellKind& kind) { ++count_[{kind.dimension, kind.name}]; }
    /// For names that live no longer than the call.
    void add(int dimension, const std::string& name) { ++named_[{dimension, name}]; }
    /// Notes what was skipped. @throws lancet::Error where there are volume cells that are not linear tetrahedra.
    void report(const std::string& file, std::vector<std::string>& notes) const;

  private:
    std::map<std::pair<int, std::string_view>, std::size_t> count_;
    std::map<std::pair<int, std::string>, std::size_t> named_;
};

/// Finds nodes and elements by the numbers that a file gives them.
class NumberMap {
  public:
    /// Takes the file's numbers in the order of our own. Fails, at the cursor's place, where one occurs twice or where
    /// there are more than 32-bit numbers count.
    void build(const std::vector<std::int64_t>& numbers, const Cursor& cursor, const char* what);
    /// Our number, or -1.
    std::int32_t find(std::int64_t number) const;

  private:
    std::int64_t lowest_ = 0;
    std::vector<std::int32_t> dense_;
    std::vector<std::pair<std::int64_t, std::int32_t>> sorted_;
};

/// The readers. `cursor` stands at the beginning of the file.
RawMesh read_gmsh(Cursor& cursor);
RawMesh read_vtk_legacy(Cursor& cursor);
RawMesh read_vtk_xml(std::string_view content, const std::string& name);
RawMesh read_tetgen(Cursor& nodes, Cursor& elements);
RawMesh read_abaqus(Cursor& cursor);

}  // namespace lancet::mesh::io
