#include "lancet/mesh/io/load.hpp"

#include <fstream>
#include <system_error>

#include "lancet/kernels/error.hpp"

namespace lancet::mesh::io {

std::string load(const std::filesystem::path& path, const char* expected) {
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) {
        throw Error(path.string() + ": is a folder; expected " + expected);
    }
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    const std::streamoff size = file ? std::streamoff(file.tellg()) : -1;
    if (size < 0) throw Error(path.string() + ": cannot be opened for reading");
    std::string content(static_cast<std::size_t>(size), '\0');
    file.seekg(0);
    if (!file.read(content.data(), size)) throw Error(path.string() + ": cannot be read to its end");
    return content;
}

}  // namespace lancet::mesh::io
