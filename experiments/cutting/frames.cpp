#include "lancet/experiments/cutting/frames.hpp"

#include <system_error>
#include <utility>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/io/write_vtu.hpp"

namespace lancet::experiments::cutting {

Frames::Frames(std::filesystem::path folder, std::string name) : folder_(std::move(folder)), name_(std::move(name)) {
    std::error_code error;
    std::filesystem::create_directories(folder_ / name_, error);
    if (error) throw Error((folder_ / name_).string() + ": cannot be made: " + error.message());
}

void Frames::add(const Shape& shape) {
    const mesh::PartGeometry& geometry = shape.geometry;
    std::vector<std::int32_t> part = geometry.part_of_tetrahedron;
    part.insert(part.end(), geometry.part_of_triangle.begin(), geometry.part_of_triangle.end());
    std::vector<std::int32_t> surface(geometry.tetrahedra.size(), 0);
    for (const std::uint8_t is_wall : geometry.is_wall) surface.push_back(is_wall != 0 ? 2 : 1);
    const std::filesystem::path file = std::filesystem::path(name_) / (std::to_string(frames_.size()) + ".vtu");
    mesh::write_vtu(folder_ / file,
                    {.points = shape.points, .tetrahedra = geometry.tetrahedra, .triangles = geometry.triangles},
                    {.cell_data = {{"part", 1, std::span<const std::int32_t>(part)},
                                   {"surface", 1, std::span<const std::int32_t>(surface)}}});
    frames_.push_back({shape.time, file});
    mesh::write_pvd(folder_ / (name_ + ".pvd"), frames_);
}

}  // namespace lancet::experiments::cutting
