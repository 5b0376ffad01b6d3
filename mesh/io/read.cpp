#include "lancet/mesh/io/read.hpp"

#include <optional>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/io/cursor.hpp"
#include "lancet/mesh/io/load.hpp"
#include "lancet/mesh/io/raw_mesh.hpp"

namespace lancet::mesh {

namespace {

std::optional<MeshFormat> format_of_content(std::string_view content) {
    if (content.starts_with("\xEF\xBB\xBF")) content.remove_prefix(3);
    content = io::trimmed(content.substr(0, 4096));
    if (content.starts_with("$")) return MeshFormat::gmsh;
    if (io::lower(content.substr(0, 5)) == "# vtk") return MeshFormat::vtk_legacy;
    if (content.starts_with("<")) return MeshFormat::vtk_xml;
    return std::nullopt;
}

std::optional<MeshFormat> format_of_extension(const std::string& extension) {
    if (extension == ".msh") return MeshFormat::gmsh;
    if (extension == ".vtk") return MeshFormat::vtk_legacy;
    if (extension == ".vtu") return MeshFormat::vtk_xml;
    if (extension == ".inp") return MeshFormat::abaqus;
    if (extension == ".node" || extension == ".ele") return MeshFormat::tetgen;
    return std::nullopt;
}

ReadResult read_tetgen_pair(const std::string& nodes, const std::string& nodes_name, const std::string& elements,
                            const std::string& elements_name, const ReadOptions& options) {
    io::Cursor node_cursor(nodes, nodes_name);
    io::Cursor element_cursor(elements, elements_name);
    return io::finish(io::read_tetgen(node_cursor, element_cursor), nodes_name, options);
}

}  // namespace

ReadResult read_from_memory(MeshFormat format, std::string_view content, std::string_view second,
                            const std::string& name, const ReadOptions& options) {
    io::Cursor cursor(content, name);
    switch (format) {
        case MeshFormat::gmsh:
            return io::finish(io::read_gmsh(cursor), name, options);
        case MeshFormat::vtk_legacy:
            return io::finish(io::read_vtk_legacy(cursor), name, options);
        case MeshFormat::vtk_xml:
            return io::finish(io::read_vtk_xml(content, name), name, options);
        case MeshFormat::tetgen: {
            const std::string elements_name = name + " (elements)";
            io::Cursor elements(second, elements_name);
            return io::finish(io::read_tetgen(cursor, elements), name, options);
        }
        case MeshFormat::abaqus:
            return io::finish(io::read_abaqus(cursor), name, options);
    }
    throw Error(name + ": no such mesh format");
}

ReadResult read(const std::filesystem::path& path, const ReadOptions& options) {
    const std::string extension = io::lower(path.extension().string());
    const std::optional<MeshFormat> by_extension = format_of_extension(extension);
    const std::string content = io::load(path, "a mesh file");
    if (by_extension == MeshFormat::tetgen) {
        std::filesystem::path other = path;
        other.replace_extension(extension == ".node" ? ".ele" : ".node");
        const std::string other_content = io::load(other, "a mesh file");
        if (extension == ".node") {
            return read_tetgen_pair(content, path.string(), other_content, other.string(), options);
        }
        return read_tetgen_pair(other_content, other.string(), content, path.string(), options);
    }
    const std::optional<MeshFormat> by_content = format_of_content(content);
    if (!by_content && !by_extension) {
        throw Error(path.string() + ": not a known mesh file; expected .msh, .vtk, .vtu, .node and .ele, or .inp");
    }
    return read_from_memory(by_content ? *by_content : *by_extension, content, {}, path.string(), options);
}

}  // namespace lancet::mesh
