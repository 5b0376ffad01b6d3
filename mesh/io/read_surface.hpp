#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "lancet/mesh/surface/triangle_mesh.hpp"

namespace lancet::mesh {

enum class SurfaceFormat {
    obj,  ///< .obj (Wavefront): vertices and faces; everything else is skipped
    stl,  ///< .stl: ASCII and binary
    ply   ///< .ply: ASCII and binary in either byte order; elements and properties it does not need are skipped
};

struct ReadSurfaceOptions {
    /// Coordinates are multiplied by this.
    double scale = 1;
};

/// Reads a surface of triangles; polygons are divided into fans. Vertices in the same place are one in STL, which
/// repeats them; in the other formats the file says what is one. Vertices that no triangle uses are kept.
/// @throws lancet::Error that names the file, the line or byte, and what was expected; also where there is no face.
TriangleMesh read_surface(const std::filesystem::path& path, const ReadSurfaceOptions& options = {});

/// Reads from memory. `name` stands for the file in messages.
TriangleMesh read_surface_from_memory(SurfaceFormat format, std::string_view content,
                                      const std::string& name = "memory", const ReadSurfaceOptions& options = {});

}  // namespace lancet::mesh
