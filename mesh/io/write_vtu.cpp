#include "lancet/mesh/io/write_vtu.hpp"

#include <bit>
#include <functional>
#include <set>
#include <string_view>
#include <utility>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/io/atomic_file.hpp"

namespace lancet::mesh {

namespace {

using io::AtomicFile;

/// Writes the description of the arrays first and their bytes afterwards.
class Appender {
  public:
    explicit Appender(AtomicFile& file) : file_(file) {}

    template <typename Value>
    void add(std::string_view type, std::string_view name, int components, std::span<const Value> values) {
        file_ << "        <DataArray type=\"" << type << "\" Name=\"" << io::escaped_xml(name)
              << "\" NumberOfComponents=\"";
        file_.number(components) << "\" format=\"appended\" offset=\"";
        file_.number(offset_) << "\"/>\n";
        offset_ += sizeof(std::uint64_t) + values.size_bytes();
        blocks_.push_back([this, values] { file_.binary(std::uint64_t{values.size_bytes()}).binary(values); });
    }

    void write_blocks() {
        for (const auto& block : blocks_) block();
    }

  private:
    AtomicFile& file_;
    std::uint64_t offset_ = 0;
    std::vector<std::function<void()>> blocks_;
};

void add_arrays(const std::vector<VtuArray>& arrays, Appender& appender) {
    for (const VtuArray& array : arrays) {
        std::visit(
            [&]<typename Value>(std::span<const Value> values) {
                const std::string_view type = std::is_same_v<Value, double>  ? "Float64"
                                              : std::is_same_v<Value, float> ? "Float32"
                                                                             : "Int32";
                appender.add(type, array.name, array.components, values);
            },
            array.values);
    }
}

void check(const std::filesystem::path& path, const std::vector<VtuArray>& arrays, std::size_t places,
           const char* of_what, std::set<std::string> taken) {
    for (const VtuArray& array : arrays) {
        const std::string where = path.string() + ": array '" + array.name + "' of the " + of_what;
        if (array.components < 1) throw Error(where + " has " + std::to_string(array.components) + " components");
        const std::size_t expected = places * static_cast<std::size_t>(array.components);
        const std::size_t found = std::visit([](const auto& values) { return values.size(); }, array.values);
        if (found != expected) {
            throw Error(where + " has " + std::to_string(found) + " values; expected " + std::to_string(expected));
        }
        if (!taken.insert(array.name).second) throw Error(where + " has a name that is already taken");
    }
}

/// What a mesh says of itself, beside the user's arrays.
struct OwnArrays {
    std::vector<std::pair<std::string, std::span<const std::uint8_t>>> of_points{};
    std::span<const std::int32_t> regions{};
};

void write(const std::filesystem::path& path, const VtuGrid& grid, const VtuContent& content, const OwnArrays& own) {
    const std::size_t tetrahedra = grid.tetrahedra.size(), cells = tetrahedra + grid.triangles.size();
    std::vector<std::int32_t> connectivity;
    std::vector<std::int64_t> ends;
    std::vector<std::uint8_t> types;
    const auto add_cells = [&](const auto& shapes, std::uint8_t type) {
        for (const auto& shape : shapes) {
            connectivity.insert(connectivity.end(), shape.begin(), shape.end());
            ends.push_back(static_cast<std::int64_t>(connectivity.size()));
            types.push_back(type);
        }
    };
    constexpr std::uint8_t vtk_triangle = 5, vtk_tetrahedron = 10;
    add_cells(grid.tetrahedra, vtk_tetrahedron);
    add_cells(grid.triangles, vtk_triangle);
    const std::span<const double> coordinates(grid.points.empty() ? nullptr : grid.points.front().data(),
                                              3 * grid.points.size());

    AtomicFile file(path);
    Appender appender(file);
    file << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\""
         << (std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian")
         << "\" header_type=\"UInt64\">\n  <UnstructuredGrid>\n    <Piece NumberOfPoints=\"";
    file.number(grid.points.size()) << "\" NumberOfCells=\"";
    file.number(cells) << "\">\n      <Points>\n";
    appender.add("Float64", "Points", 3, coordinates);
    file << "      </Points>\n      <Cells>\n";
    appender.add("Int32", "connectivity", 1, std::span<const std::int32_t>(connectivity));
    appender.add("Int64", "offsets", 1, std::span<const std::int64_t>(ends));
    appender.add("UInt8", "types", 1, std::span<const std::uint8_t>(types));
    file << "      </Cells>\n      <PointData>\n";
    add_arrays(content.point_data, appender);
    for (const auto& [name, values] : own.of_points) appender.add("UInt8", name, 1, values);
    file << "      </PointData>\n      <CellData>\n";
    if (!own.regions.empty()) appender.add("Int32", "region", 1, own.regions);
    add_arrays(content.cell_data, appender);
    file << "      </CellData>\n    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n_";
    appender.write_blocks();
    file << "\n  </AppendedData>\n</VTKFile>\n";
    file.commit();
}

}  // namespace

void write_vtu(const std::filesystem::path& path, const TetMesh& mesh, const VtuContent& content) {
    const std::span<const Point> positions = content.positions.empty() ? mesh.nodes() : content.positions;
    if (positions.size() != mesh.nodes().size()) {
        throw Error(path.string() + ": " + std::to_string(positions.size()) + " positions for " +
                    std::to_string(mesh.nodes().size()) + " nodes");
    }
    std::set<std::string> set_names;
    for (const auto& [name, members] : mesh.node_sets()) set_names.insert("set:" + name);
    check(path, content.point_data, mesh.nodes().size(), "nodes", set_names);
    check(path, content.cell_data, mesh.tetrahedra().size(), "elements", {"region"});

    std::vector<std::vector<std::uint8_t>> sets;
    OwnArrays own{.regions = mesh.regions()};
    for (const auto& [name, members] : mesh.node_sets()) {
        auto& set = sets.emplace_back(mesh.nodes().size(), std::uint8_t{0});
        for (const std::int32_t node : members) set[node] = 1;
        own.of_points.emplace_back("set:" + name, set);
    }
    write(path, {.points = positions, .tetrahedra = mesh.tetrahedra()}, content, own);
}

void write_vtu(const std::filesystem::path& path, const VtuGrid& grid, const VtuContent& content) {
    check(path, content.point_data, grid.points.size(), "points", {});
    check(path, content.cell_data, grid.tetrahedra.size() + grid.triangles.size(), "cells", {});
    write(path, grid, content, {});
}

}  // namespace lancet::mesh
