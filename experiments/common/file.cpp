#include "lancet/experiments/common/file.hpp"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

#include <unistd.h>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments {
namespace {

/// A file that disappears again unless it was kept under its final name.
class TemporaryFile {
  public:
    explicit TemporaryFile(const std::filesystem::path& final_name)
        : final_name_(final_name), name_(final_name.string() + ".part" + std::to_string(::getpid())) {}
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile() {
        std::error_code ignored;
        if (!kept_) std::filesystem::remove(name_, ignored);
    }

    [[nodiscard]] const std::filesystem::path& name() const { return name_; }

    void keep() {
        std::error_code error;
        std::filesystem::rename(name_, final_name_, error);
        if (error) throw Error("cannot write '" + final_name_.string() + "': " + error.message());
        kept_ = true;
    }

  private:
    std::filesystem::path final_name_;
    std::filesystem::path name_;
    bool kept_ = false;
};

[[noreturn]] void fail(const std::filesystem::path& file) {
    const int cause = errno;
    throw Error("cannot write '" + file.string() + "': " + (cause != 0 ? std::strerror(cause) : "output error"));
}

nlohmann::ordered_json without_non_finite(const nlohmann::ordered_json& value) {
    if (value.is_number_float()) {
        const double number = value.get<double>();
        if (std::isnan(number)) return "nan";
        if (std::isinf(number)) return number > 0 ? "inf" : "-inf";
        return value;
    }
    if (!value.is_structured()) return value;
    nlohmann::ordered_json copy = value;
    for (nlohmann::ordered_json& child : copy) child = without_non_finite(child);
    return copy;
}

}  // namespace

void write_file(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write) {
    TemporaryFile temporary(file);
    errno = 0;
    std::ofstream stream(temporary.name(), std::ios::binary | std::ios::trunc);
    if (!stream) fail(file);
    write(stream);
    errno = 0;
    stream.close();
    if (!stream) fail(file);
    temporary.keep();
}

void write_file(const std::filesystem::path& file, std::string_view text) {
    write_file(file,
               [text](std::ostream& stream) { stream.write(text.data(), static_cast<std::streamsize>(text.size())); });
}

void write_json_file(const std::filesystem::path& file, const nlohmann::ordered_json& document) {
    write_file(file, without_non_finite(document).dump(2) + "\n");
}

}  // namespace lancet::experiments
