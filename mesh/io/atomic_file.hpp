#pragma once

#include <charconv>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace lancet::mesh::io {

/// A file that appears under its name only when it is complete. Until then it is written beside it under a temporary
/// name, and removed again if commit() is not reached.
class AtomicFile {
  public:
    /// @throws lancet::Error where the file cannot be made.
    explicit AtomicFile(std::filesystem::path path);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    AtomicFile& operator<<(std::string_view text) {
        stream_.write(text.data(), static_cast<std::streamsize>(text.size()));
        return *this;
    }
    /// A number as text: the shortest that reads back to the same value.
    template <typename Value>
    AtomicFile& number(Value value) {
        char text[32];
        const auto end = std::to_chars(text, text + sizeof(text), value).ptr;
        return *this << std::string_view(text, static_cast<std::size_t>(end - text));
    }
    /// The bytes of numbers as they lie in memory.
    template <typename Value>
    AtomicFile& binary(std::span<const Value> values) {
        static_assert(std::is_trivially_copyable_v<Value>);
        stream_.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size_bytes()));
        return *this;
    }
    template <typename Value>
    AtomicFile& binary(const Value& value) {
        return binary(std::span<const Value>(&value, 1));
    }

    /// Closes the file and gives it its name. @throws lancet::Error where writing or renaming failed.
    void commit();

  private:
    std::filesystem::path path_;
    std::filesystem::path temporary_;
    std::ofstream stream_;
};

/// Text with &, <, >, and quotes replaced for XML.
std::string escaped_xml(std::string_view text);

}  // namespace lancet::mesh::io
