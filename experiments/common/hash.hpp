#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>

namespace lancet::experiments {

/// 64-bit FNV-1a hash of values, bit for bit.
class Hash {
  public:
    template <class Value>
    void add(std::span<const Value> values) {
        for (const std::byte byte : std::as_bytes(values)) {
            value_ = (value_ ^ std::to_integer<std::uint64_t>(byte)) * 0x100000001b3ULL;
        }
    }
    /// 16 hexadecimal digits.
    [[nodiscard]] std::string text() const {
        std::array<char, 17> buffer{};
        std::snprintf(buffer.data(), buffer.size(), "%016llx", static_cast<unsigned long long>(value_));
        return buffer.data();
    }

  private:
    std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

}  // namespace lancet::experiments
