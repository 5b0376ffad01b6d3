// The first byte chooses the format; TetGen's two files are parted by the first byte of value 0.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/inspect.hpp"
#include "lancet/mesh/io/read.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using lancet::mesh::MeshFormat;
    if (size == 0) return 0;
    const auto format = static_cast<MeshFormat>(data[0] % 5);
    std::string_view content(reinterpret_cast<const char*>(data) + 1, size - 1);
    std::string_view second;
    if (format == MeshFormat::tetgen) {
        const std::size_t parting = content.find('\0');
        if (parting != std::string_view::npos) second = content.substr(parting + 1);
        content = content.substr(0, parting);
    }
    try {
        const auto result = lancet::mesh::read_from_memory(format, content, second);
        if (!lancet::mesh::inspect(result.mesh.definition()).clean()) __builtin_trap();
    } catch (const lancet::Error&) {
        return 0;
    }
    return 0;
}
