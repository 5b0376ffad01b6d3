#pragma once

#include <filesystem>
#include <vector>

#include "lancet/experiments/common/renderer.hpp"
#include "lancet/experiments/pipeline/world.hpp"
#include "lancet/mesh/io/write_pvd.hpp"

namespace lancet::experiments::pipeline {

/// Draws frames, and where there is a folder writes them: NUMBER.png, and the surface for ParaView as NUMBER.vtu with
/// the index frames.pvd.
class Pictures {
  public:
    /// `folder` may be empty. Throws lancet::Error where it cannot be made.
    Pictures(const World& world, int width, int height, std::filesystem::path folder);

    /// Throws lancet::Error where a file cannot be written.
    void take(const runtime::Frame& frame);

    /// Pixels that show a body or a tool, of the last frame: an empty picture is a defect that numbers do not show.
    [[nodiscard]] std::int64_t written() const noexcept { return static_cast<std::int64_t>(frames_.size()); }

  private:
    Camera camera_;
    runtime::CapsuleTool tool_;
    Renderer renderer_;
    std::filesystem::path folder_;
    std::vector<mesh::PvdFrame> frames_;
};

}  // namespace lancet::experiments::pipeline
