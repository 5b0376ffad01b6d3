#include "lancet/mesh/io/vtk_data.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include <zlib.h>

namespace lancet::mesh::io {

namespace {

/// Bytes in a file as they are or in base64. Each array and each compression header is padded by itself, so that
/// decoding goes on behind padding.
class ByteStream {
  public:
    ByteStream(const VtkArray& array, const Cursor& place)
        : coded_(array.layout == VtkArray::Layout::base64),
          place_(place),
          cursor_(place.part(array.begin, array.end)) {}

    /// The most bytes that may be left.
    std::size_t at_most_left() const { return coded_ ? cursor_.remaining() / 4 * 3 + 3 : cursor_.remaining(); }

    void read(void* to, std::size_t size) {
        if (size > at_most_left()) fail_short(size);
        auto* bytes = static_cast<unsigned char*>(to);
        if (!coded_) {
            if (size > 0) std::memcpy(bytes, cursor_.bytes(size, "an array").data(), size);
            return;
        }
        for (std::size_t n = 0; n < size; ++n) {
            if (at_ == held_) refill(size - n);
            bytes[n] = held_bytes_[at_++];
        }
    }

    /// The next number of a header.
    std::uint64_t header(const VtkCoding& coding) {
        if (coding.wide_header) return number<std::uint64_t>(coding.swap);
        return number<std::uint32_t>(coding.swap);
    }

  private:
    template <typename Value>
    Value number(bool swap) {
        Value value{};
        read(&value, sizeof(Value));
        return swap ? byte_swapped(value) : value;
    }

    [[noreturn]] void fail_short(std::size_t size) const {
        place_.fail("the data end (byte " + std::to_string(cursor_.position()) + ") where " + std::to_string(size) +
                    " more bytes are expected");
    }

    static int digit(char c) {
        if (c >= 'A' && c <= 'Z') return c - 'A';
        if (c >= 'a' && c <= 'z') return c - 'a' + 26;
        if (c >= '0' && c <= '9') return c - '0' + 52;
        if (c == '+') return 62;
        return c == '/' ? 63 : -1;
    }

    /// Decodes the next four characters.
    void refill(std::size_t wanted) {
        std::uint32_t bits = 0;
        std::size_t padding = 0;
        for (int n = 0; n < 4; ++n) {
            if (cursor_.at_end()) fail_short(wanted);
            const char c = cursor_.bytes(1, "an array").front();
            bits <<= 6;
            if (c == '=' && n >= 2) {
                ++padding;
            } else if (digit(c) >= 0 && padding == 0) {
                bits |= static_cast<std::uint32_t>(digit(c));
            } else {
                place_.fail("byte " + std::to_string(cursor_.position() - 1) + " is " + in_quotes(std::string(1, c)) +
                            "; expected base64");
            }
        }
        held_bytes_ = {static_cast<unsigned char>(bits >> 16), static_cast<unsigned char>(bits >> 8),
                       static_cast<unsigned char>(bits)};
        at_ = 0;
        held_ = 3 - padding;
    }

    bool coded_;
    const Cursor& place_;
    Cursor cursor_;
    std::array<unsigned char, 3> held_bytes_{};
    std::size_t at_ = 0;
    std::size_t held_ = 0;
};

void inflate_block(const std::vector<unsigned char>& packed, unsigned char* to, std::size_t size, const Cursor& place) {
    uLongf unpacked = static_cast<uLongf>(size);
    const int status = uncompress(to, &unpacked, packed.data(), static_cast<uLong>(packed.size()));
    if (status != Z_OK || unpacked != size) {
        place.fail("a block of zlib data does not unpack to " + std::to_string(size) + " bytes");
    }
}

/// Header: number of blocks, size of a block, size of the last one if shorter (or 0), packed size of each.
std::vector<unsigned char> read_compressed(ByteStream& stream, const VtkCoding& coding, std::size_t size,
                                           const Cursor& place) {
    const std::uint64_t blocks = stream.header(coding);
    const std::uint64_t block_size = stream.header(coding);
    const std::uint64_t last_size = stream.header(coding);
    const auto mismatch = [&] {
        place.fail("the blocks of zlib data do not unpack to the " + std::to_string(size) + " bytes expected");
    };
    // Deflate packs at most 1032 bytes into one.
    constexpr std::size_t best_ratio = 1032;
    if (size / best_ratio > stream.at_most_left()) {
        place.fail(std::to_string(size) + " bytes are expected, more than zlib can have packed into the file");
    }
    if (blocks > stream.at_most_left() / (coding.wide_header ? 8 : 4)) mismatch();
    std::vector<std::uint64_t> packed_sizes(static_cast<std::size_t>(blocks));
    for (std::uint64_t& packed : packed_sizes) packed = stream.header(coding);

    std::vector<unsigned char> result(size);
    std::vector<unsigned char> packed;
    std::size_t at = 0;
    for (std::size_t b = 0; b < packed_sizes.size(); ++b) {
        const std::uint64_t unpacked = b + 1 == packed_sizes.size() && last_size != 0 ? last_size : block_size;
        if (unpacked > size - at) mismatch();
        if (packed_sizes[b] > stream.at_most_left()) place.fail("a block of zlib data is longer than the file");
        packed.resize(static_cast<std::size_t>(packed_sizes[b]));
        stream.read(packed.data(), packed.size());
        if (unpacked > 0) inflate_block(packed, result.data() + at, static_cast<std::size_t>(unpacked), place);
        at += static_cast<std::size_t>(unpacked);
    }
    if (at != size) mismatch();
    return result;
}

std::vector<unsigned char> read_bytes(const VtkArray& array, const VtkCoding& coding, std::size_t size,
                                      const Cursor& place) {
    ByteStream stream(array, place);
    if (coding.compressed) return read_compressed(stream, coding, size, place);
    const std::uint64_t announced = stream.header(coding);
    if (announced != size) {
        place.fail("an array of " + std::to_string(announced) + " bytes; expected " + std::to_string(size));
    }
    if (size > stream.at_most_left()) {
        place.fail("an array of " + std::to_string(size) + " bytes; the rest of the file holds at most " +
                   std::to_string(stream.at_most_left()));
    }
    std::vector<unsigned char> result(size);
    stream.read(result.data(), size);
    return result;
}

template <typename Value, typename Stored>
std::vector<Value> convert(const VtkArray& array, const VtkCoding& coding, std::size_t count, const Cursor& place) {
    constexpr bool real = std::is_floating_point_v<Stored>;
    if (real && !std::is_floating_point_v<Value>)
        place.fail("numbers of the type " + array.type + "; expected integers");
    if (count > std::numeric_limits<std::size_t>::max() / sizeof(Stored)) place.fail("absurdly many values");
    const auto bytes = read_bytes(array, coding, count * sizeof(Stored), place);
    std::vector<Value> result(count);
    for (std::size_t n = 0; n < count; ++n) {
        Stored value;
        std::memcpy(&value, bytes.data() + n * sizeof(Stored), sizeof(Stored));
        if (coding.swap) value = byte_swapped(value);
        if constexpr (real) {
            if (!std::isfinite(value)) place.fail("value " + std::to_string(n) + " is not a finite number");
        }
        result[n] = static_cast<Value>(value);
    }
    return result;
}

template <typename Value>
std::vector<Value> read_text(const VtkArray& array, std::size_t count, const Cursor& place) {
    Cursor cursor = place.part(array.begin, array.end);
    std::vector<Value> result(cursor.checked_count(static_cast<std::int64_t>(count), "the number of values", 2));
    for (Value& value : result) {
        if constexpr (std::is_same_v<Value, double>) value = cursor.number("a value");
        if constexpr (!std::is_same_v<Value, double>) value = cursor.integer("a value");
    }
    if (!cursor.at_end()) {
        const std::string found = in_quotes(cursor.peek_word());
        cursor.fail("expected the end of " + std::to_string(count) + " values, but found " + found);
    }
    return result;
}

template <typename Value>
std::vector<Value> read_array(const VtkArray& array, const VtkCoding& coding, std::size_t count, const Cursor& place) {
    if (array.layout == VtkArray::Layout::ascii) return read_text<Value>(array, count, place);
    const std::string& type = array.type;
    if (type == "Float32") return convert<Value, float>(array, coding, count, place);
    if (type == "Float64") return convert<Value, double>(array, coding, count, place);
    if (type == "Int8") return convert<Value, std::int8_t>(array, coding, count, place);
    if (type == "UInt8") return convert<Value, std::uint8_t>(array, coding, count, place);
    if (type == "Int16") return convert<Value, std::int16_t>(array, coding, count, place);
    if (type == "UInt16") return convert<Value, std::uint16_t>(array, coding, count, place);
    if (type == "Int32") return convert<Value, std::int32_t>(array, coding, count, place);
    if (type == "UInt32") return convert<Value, std::uint32_t>(array, coding, count, place);
    if (type == "Int64") return convert<Value, std::int64_t>(array, coding, count, place);
    if (type == "UInt64") return convert<Value, std::uint64_t>(array, coding, count, place);
    place.fail("numbers of the type " + in_quotes(type) + " are not known");
}

}  // namespace

std::vector<double> read_vtk_reals(const VtkArray& array, const VtkCoding& coding, std::size_t count,
                                   const Cursor& place) {
    return read_array<double>(array, coding, count, place);
}

std::vector<std::int64_t> read_vtk_integers(const VtkArray& array, const VtkCoding& coding, std::size_t count,
                                            const Cursor& place) {
    return read_array<std::int64_t>(array, coding, count, place);
}

}  // namespace lancet::mesh::io
