#include "lancet/mesh/io/vtk_cells.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace lancet::mesh::io {

namespace {

constexpr std::int64_t tetrahedron_type = 10;

const CellKind* kind_of(std::int64_t type) {
    static constexpr std::array<CellKind, 17> linear{{{"empty cells", 0, 0},
                                                      {"vertices", 0, 1},
                                                      {"sets of vertices", 0, 0},
                                                      {"lines", 1, 2},
                                                      {"sets of lines", 1, 0},
                                                      {"triangles", 2, 3},
                                                      {"triangle strips", 2, 0},
                                                      {"polygons", 2, 0},
                                                      {"pixels", 2, 4},
                                                      {"quadrilaterals", 2, 4},
                                                      {"tetrahedra", 3, 4},
                                                      {"voxels", 3, 8},
                                                      {"hexahedra", 3, 8},
                                                      {"wedges", 3, 6},
                                                      {"pyramids", 3, 5},
                                                      {"pentagonal prisms", 3, 10},
                                                      {"hexagonal prisms", 3, 12}}};
    static constexpr std::array<CellKind, 17> quadratic{{{"quadratic lines", 1, 3},
                                                         {"quadratic triangles", 2, 6},
                                                         {"quadratic quadrilaterals", 2, 8},
                                                         {"quadratic tetrahedra", 3, 10},
                                                         {"quadratic hexahedra", 3, 20},
                                                         {"quadratic wedges", 3, 15},
                                                         {"quadratic pyramids", 3, 13},
                                                         {"biquadratic quadrilaterals", 2, 9},
                                                         {"triquadratic hexahedra", 3, 27},
                                                         {"linear-quadratic quadrilaterals", 2, 6},
                                                         {"linear-quadratic wedges", 3, 12},
                                                         {"biquadratic wedges", 3, 18},
                                                         {"biquadratic hexahedra", 3, 24},
                                                         {"biquadratic triangles", 2, 7},
                                                         {"cubic lines", 1, 4},
                                                         {"quadratic polygons", 2, 0},
                                                         {"triquadratic pyramids", 3, 19}}};
    static constexpr CellKind polyhedra{"polyhedra", 3, 0};
    if (type >= 0 && type <= 16) return &linear[static_cast<std::size_t>(type)];
    if (type >= 21 && type <= 37) return &quadratic[static_cast<std::size_t>(type - 21)];
    return type == 42 ? &polyhedra : nullptr;
}

}  // namespace

std::vector<std::size_t> append_vtk_cells(const VtkCells& cells, std::size_t first_node, std::size_t node_count,
                                          const Cursor& cursor, RawMesh& raw, OtherCells& others) {
    std::vector<std::size_t> taken;
    taken.reserve(cells.types.size());
    std::int64_t begin = 0;
    for (std::size_t c = 0; c < cells.types.size(); ++c) {
        const std::int64_t end = cells.ends[c];
        const auto fail = [&](const std::string& message) {
            cursor.fail("cell " + std::to_string(c) + ": " + message);
        };
        if (end < begin || static_cast<std::uint64_t>(end) > cells.connectivity.size()) {
            fail("its nodes end at " + std::to_string(end) + " of " + std::to_string(cells.connectivity.size()) +
                 " and begin at " + std::to_string(begin));
        }
        const CellKind* kind = kind_of(cells.types[c]);
        if (kind == nullptr) {
            fail("cell type " + std::to_string(cells.types[c]) + " is not known; expected 0 to 16, 21 to 37 or 42");
        }
        if (kind->nodes != 0 && end - begin != kind->nodes) {
            fail(std::to_string(end - begin) + " nodes for a cell of the type " + kind->name + "; expected " +
                 std::to_string(kind->nodes));
        }
        if (cells.types[c] == tetrahedron_type) {
            Tetrahedron& t = raw.definition.tetrahedra.emplace_back();
            for (std::size_t n = 0; n < 4; ++n) {
                const std::int64_t node = cells.connectivity[static_cast<std::size_t>(begin) + n];
                if (node < 0 || static_cast<std::uint64_t>(node) >= node_count) {
                    fail("node " + std::to_string(node) + " is not one of the " + std::to_string(node_count) +
                         " points");
                }
                t[n] = static_cast<std::int32_t>(first_node + static_cast<std::size_t>(node));
            }
            taken.push_back(c);
        } else {
            others.add(*kind);
        }
        begin = end;
    }
    return taken;
}

bool is_region_name(std::string_view name) {
    const std::string small = lower(name);
    for (const char* known :
         {"region", "regions", "material", "materialids", "cellentityids", "gmsh:physical", "medit:ref"}) {
        if (small == known) return true;
    }
    return false;
}

bool set_regions(const std::vector<double>& values, const std::vector<std::size_t>& taken, RawMesh& raw) {
    for (const std::size_t cell : taken) {
        if (!(std::abs(values[cell]) <= std::numeric_limits<std::int32_t>::max())) return false;
        if (values[cell] != std::floor(values[cell])) return false;
    }
    raw.definition.regions.resize(raw.definition.tetrahedra.size(), 0);
    const std::size_t first = raw.definition.tetrahedra.size() - taken.size();
    for (std::size_t t = 0; t < taken.size(); ++t) {
        raw.definition.regions[first + t] = static_cast<std::int32_t>(values[taken[t]]);
    }
    return true;
}

}  // namespace lancet::mesh::io
