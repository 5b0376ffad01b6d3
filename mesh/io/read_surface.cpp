#include "lancet/mesh/io/read_surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/io/load.hpp"
#include "lancet/mesh/io/surface_formats.hpp"

namespace lancet::mesh {

namespace io {

void add_polygon(TriangleMesh& surface, std::span<const std::int32_t> corners) {
    for (std::size_t k = 2; k < corners.size(); ++k) {
        surface.triangles.push_back({corners[0], corners[k - 1], corners[k]});
    }
}

TriangleMesh merged(const TriangleMesh& surface) {
    TriangleMesh result;
    std::map<Point, std::int32_t> numbers;  // -0 and 0 are equal here, as they should
    std::vector<std::int32_t> number_of(surface.vertices.size());
    for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
        const auto [place, is_new] =
            numbers.try_emplace(surface.vertices[v], static_cast<std::int32_t>(result.vertices.size()));
        if (is_new) result.vertices.push_back(surface.vertices[v]);
        number_of[v] = place->second;
    }
    result.triangles.reserve(surface.triangles.size());
    for (const auto& [a, b, c] : surface.triangles) {
        result.triangles.push_back({number_of[static_cast<std::size_t>(a)], number_of[static_cast<std::size_t>(b)],
                                    number_of[static_cast<std::size_t>(c)]});
    }
    return result;
}

}  // namespace io

namespace {

std::optional<SurfaceFormat> format_of_extension(const std::string& extension) {
    if (extension == ".obj") return SurfaceFormat::obj;
    if (extension == ".stl") return SurfaceFormat::stl;
    if (extension == ".ply") return SurfaceFormat::ply;
    return std::nullopt;
}

TriangleMesh read_format(SurfaceFormat format, io::Cursor& file) {
    switch (format) {
        case SurfaceFormat::obj:
            return io::read_obj(file);
        case SurfaceFormat::stl:
            return io::read_stl(file);
        case SurfaceFormat::ply:
            return io::read_ply(file);
    }
    throw Error(file.name() + ": no such surface format");
}

}  // namespace

TriangleMesh read_surface_from_memory(SurfaceFormat format, std::string_view content, const std::string& name,
                                      const ReadSurfaceOptions& options) {
    if (!(options.scale > 0) || !std::isfinite(options.scale)) {
        throw Error(name + ": scale " + std::to_string(options.scale) + "; expected a positive finite number");
    }
    if (io::trimmed(content).empty()) throw Error(name + ": the file is empty; expected a surface");
    io::Cursor file(content, name);
    TriangleMesh surface = read_format(format, file);
    if (surface.triangles.empty()) throw Error(name + ": has no faces; expected a surface of triangles or polygons");
    for (Point& vertex : surface.vertices) {
        for (double& value : vertex) value *= options.scale;
    }
    require_valid(name.c_str(), surface.vertices, surface.triangles);
    return surface;
}

TriangleMesh read_surface(const std::filesystem::path& path, const ReadSurfaceOptions& options) {
    const std::string content = io::load(path, "a surface file");
    const std::optional<SurfaceFormat> format = format_of_extension(io::lower(path.extension().string()));
    if (!format) throw Error(path.string() + ": not a known surface file; expected .obj, .stl or .ply");
    return read_surface_from_memory(*format, content, path.string(), options);
}

}  // namespace lancet::mesh
