#include "lancet/experiments/pipeline/pictures.hpp"

#include <cstdio>
#include <string>
#include <system_error>
#include <utility>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/io/write_vtu.hpp"

namespace lancet::experiments::pipeline {

Pictures::Pictures(const World& world, int width, int height, std::filesystem::path folder)
    : camera_(world.camera), tool_(world.tool_shape), renderer_(width, height), folder_(std::move(folder)) {
    if (folder_.empty()) return;
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    if (error) throw Error(folder_.string() + ": cannot be made: " + error.message());
}

void Pictures::take(const runtime::Frame& frame) {
    std::vector<PictureSurface> surfaces;
    for (const runtime::SurfaceShape& shape : frame.bodies) {
        if (!shape.surface) continue;
        surfaces.push_back({.positions = shape.positions,
                            .normals = shape.normals,
                            .triangles = shape.surface->triangles,
                            .is_marked = shape.surface->is_wall});
    }
    std::vector<PictureRod> rods;
    for (const runtime::ToolSample& tool : frame.tools) {
        rods.push_back({.start = runtime::place(tool.pose, tool_.start),
                        .end = runtime::place(tool.pose, tool_.end),
                        .radius = tool_.radius});
    }
    const Picture& picture = renderer_.draw(camera_, surfaces, rods);
    if (folder_.empty()) return;
    char name[32];
    std::snprintf(name, sizeof(name), "%06lld", static_cast<long long>(frame.number));
    write_png(folder_ / (std::string(name) + ".png"), picture);
    if (frame.bodies.empty() || !frame.bodies.front().surface) return;
    const runtime::SurfaceShape& shape = frame.bodies.front();
    const std::vector<std::int32_t> is_wall(shape.surface->is_wall.begin(), shape.surface->is_wall.end());
    const std::string file = std::string(name) + ".vtu";
    mesh::write_vtu(folder_ / file, mesh::VtuGrid{.points = shape.positions, .triangles = shape.surface->triangles},
                    {.cell_data = {{"wall", 1, std::span<const std::int32_t>(is_wall)}}});
    frames_.push_back({frame.time, file});
    mesh::write_pvd(folder_ / "frames.pvd", frames_);
}

}  // namespace lancet::experiments::pipeline
