#include "lancet/mesh/io/atomic_file.hpp"

#include <random>
#include <system_error>
#include <utility>

#include "lancet/kernels/error.hpp"

namespace lancet::mesh::io {

AtomicFile::AtomicFile(std::filesystem::path path) : path_(std::move(path)), temporary_(path_) {
    // Two programs that write the same file must not share the temporary one.
    temporary_ += '.';
    temporary_ += std::to_string(std::random_device()());
    temporary_ += ".part";
    stream_.open(temporary_, std::ios::binary | std::ios::trunc);
    if (!stream_) throw Error(path_.string() + ": cannot be opened for writing");
}

AtomicFile::~AtomicFile() {
    if (temporary_.empty()) return;
    stream_.close();
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
}

void AtomicFile::commit() {
    stream_.close();
    if (!stream_) throw Error(path_.string() + ": cannot be written to its end");
    std::error_code error;
    std::filesystem::rename(temporary_, path_, error);
    if (error) throw Error(path_.string() + ": cannot be given its name: " + error.message());
    temporary_.clear();
}

std::string escaped_xml(std::string_view text) {
    std::string result;
    for (const char c : text) {
        if (c == '&') {
            result += "&amp;";
        } else if (c == '<') {
            result += "&lt;";
        } else if (c == '>') {
            result += "&gt;";
        } else if (c == '"') {
            result += "&quot;";
        } else {
            result += c;
        }
    }
    return result;
}

}  // namespace lancet::mesh::io
