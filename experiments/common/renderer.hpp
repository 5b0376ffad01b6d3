#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::experiments {

using mesh::Point;
/// Red, green and blue in [0, 1].
using Colour = std::array<double, 3>;

/// From where a picture is taken: by a pinhole camera.
struct Camera {
    Point eye{0, 0, 5};
    Point target{0, 0, 0};
    Point up{0, 1, 0};
    double vertical_angle = 35;  ///< degrees
};

/// Triangles of a picture, smooth where normals are given.
struct PictureSurface {
    std::span<const Point> positions{};
    std::span<const Point> normals{};  ///< [vertex] or empty
    std::span<const mesh::Triangle> triangles{};
    std::span<const std::uint8_t> is_marked{};  ///< [triangle] or empty: those with 1 have the other colour
    Colour colour{0.80, 0.45, 0.40};
    Colour marked_colour{0.62, 0.10, 0.12};
};

/// A ball-ended rod in a picture; of one point a ball.
struct PictureRod {
    Point start{};
    Point end{};
    double radius = 0.01;
    Colour colour{0.55, 0.60, 0.68};
};

/// Rows from the top, red, green and blue of each pixel.
struct Picture {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> pixels;
};

/// Draws by casting a ray through each pixel: needs no window and no graphics card. One thread.
class Renderer {
  public:
    /// Throws lancet::Error for sizes outside of [1, 8192].
    Renderer(int width, int height);
    ~Renderer();
    Renderer(Renderer&&) noexcept;
    Renderer& operator=(Renderer&&) noexcept;

    /// Vertices that are not finite are left out with their triangles. Throws lancet::Error for a triangle with a
    /// vertex that does not exist, and a camera that looks nowhere.
    [[nodiscard]] const Picture& draw(const Camera& camera, std::span<const PictureSurface> surfaces,
                                      std::span<const PictureRod> rods);

  private:
    struct Device;
    std::unique_ptr<Device> device_;
    Picture picture_;
};

/// Writes a PNG file, which appears by rename. Throws lancet::Error where it cannot be written.
void write_png(const std::filesystem::path& file, const Picture& picture);

}  // namespace lancet::experiments
