#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lancet/experiments/cutting/shape.hpp"
#include "lancet/mesh/io/write_pvd.hpp"

namespace lancet::experiments::cutting {

/// Writes the motion of a cut body for ParaView: FOLDER/NAME.pvd, and a mesh for each frame in FOLDER/NAME. Cut
/// elements are there as their parts; the surface, with the faces of openings, as triangles. Cell data: `part`, and
/// `surface`, which is 0 for tetrahedra, 1 for the body's own surface and 2 for walls of cuts.
class Frames {
  public:
    /// Throws lancet::Error where the folder cannot be made.
    Frames(std::filesystem::path folder, std::string name);
    /// Throws lancet::Error where a file cannot be written.
    void add(const Shape& shape);

  private:
    std::filesystem::path folder_;
    std::string name_;
    std::vector<mesh::PvdFrame> frames_;
};

}  // namespace lancet::experiments::cutting
