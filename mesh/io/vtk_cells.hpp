#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "lancet/mesh/io/cursor.hpp"
#include "lancet/mesh/io/raw_mesh.hpp"

namespace lancet::mesh::io {

/// The cells of an unstructured grid of VTK.
struct VtkCells {
    std::vector<std::int64_t> types;
    /// Where the nodes of each cell end in `connectivity`; they begin where those of the cell before end.
    std::vector<std::int64_t> ends;
    std::vector<std::int64_t> connectivity;
};

/// Takes the tetrahedra among the cells; the others are counted. Nodes count from `first_node` in the mesh, of which
/// there are `node_count`. Returns the numbers of the cells that were taken. Fails at the cursor's place.
std::vector<std::size_t> append_vtk_cells(const VtkCells& cells, std::size_t first_node, std::size_t node_count,
                                          const Cursor& cursor, RawMesh& raw, OtherCells& others);

/// True for the names of cell arrays that tell regions.
bool is_region_name(std::string_view name);

/// Sets the regions of the last elements from one value per cell; false where a value is no integer of 32 bits.
bool set_regions(const std::vector<double>& values, const std::vector<std::size_t>& taken, RawMesh& raw);

}  // namespace lancet::mesh::io
