#include <string>

#include <stb/stb_image_write.h>

#include "lancet/experiments/common/file.hpp"
#include "lancet/experiments/common/renderer.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments {

void write_png(const std::filesystem::path& file, const Picture& picture) {
    std::string bytes;
    const auto append = [](void* context, void* data, int size) {
        static_cast<std::string*>(context)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
    };
    if (stbi_write_png_to_func(append, &bytes, picture.width, picture.height, 3, picture.pixels.data(),
                               3 * picture.width) == 0) {
        throw Error(file.string() + ": the picture of " + std::to_string(picture.width) + " x " +
                    std::to_string(picture.height) + " pixels cannot be encoded as PNG");
    }
    write_file(file, bytes);
}

}  // namespace lancet::experiments
