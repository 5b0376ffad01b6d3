#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace lancet::mesh {

/// One frame of a time series.
struct PvdFrame {
    /// Seconds.
    double time = 0;
    /// The .vtu file, relative to the folder of the .pvd file.
    std::filesystem::path file;
};

/// Writes the index by which ParaView opens frames as a time series. The file appears by renaming, so that it can be
/// written anew after every frame. @throws lancet::Error for times that are not finite or where writing fails.
void write_pvd(const std::filesystem::path& path, std::span<const PvdFrame> frames);

}  // namespace lancet::mesh
