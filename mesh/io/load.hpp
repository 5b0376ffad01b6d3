#pragma once

#include <filesystem>
#include <string>

namespace lancet::mesh::io {

/// The content of a file. @throws lancet::Error for a folder, which says that `expected` was expected, and for what
/// cannot be read.
std::string load(const std::filesystem::path& path, const char* expected);

}  // namespace lancet::mesh::io
