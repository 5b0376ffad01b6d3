// The low three bits of the first byte choose the format, the next ones what is repaired; TetGen's two files are parted
// by the first byte of value 0 that follows.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/inspect.hpp"
#include "lancet/mesh/io/read.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using lancet::mesh::MeshFormat;
    if (size == 0) return 0;
    const unsigned choice = data[0];
    const auto format = static_cast<MeshFormat>((choice & 7U) % 5U);
    // The repairs that are on by default are off where their bit is set, so that plain seeds are read as users do.
    const lancet::mesh::ReadOptions options{
        .repair = (choice & 8U) == 0, .drop_flat = (choice & 16U) != 0, .drop_duplicates = (choice & 32U) != 0};
    std::string_view content(reinterpret_cast<const char*>(data) + 1, size - 1);
    std::string_view second;
    if (format == MeshFormat::tetgen) {
        const std::size_t parting = content.find('\0');
        if (parting != std::string_view::npos) second = content.substr(parting + 1);
        content = content.substr(0, parting);
    }
    try {
        const auto result = lancet::mesh::read_from_memory(format, content, second, "file", options);
        if (!lancet::mesh::inspect(result.mesh.definition()).clean()) __builtin_trap();
    } catch (const lancet::Error& error) {
        // One line that names the file.
        const std::string message = error.what();
        if (!message.starts_with("file") || message.find('\n') != std::string::npos) __builtin_trap();
    }
    return 0;
}
