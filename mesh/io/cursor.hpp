#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace lancet::mesh::io {

/// Reverses the bytes of a number.
template <typename Value>
Value byte_swapped(Value value) {
    static_assert(std::is_arithmetic_v<Value>);
    unsigned char bytes[sizeof(Value)];
    std::memcpy(bytes, &value, sizeof(Value));
    for (std::size_t i = 0; i < sizeof(Value) / 2; ++i) {
        const unsigned char low = bytes[i];
        bytes[i] = bytes[sizeof(Value) - 1 - i];
        bytes[sizeof(Value) - 1 - i] = low;
    }
    std::memcpy(&value, bytes, sizeof(Value));
    return value;
}

/// A place in a file that is being read from memory. Every reading function fails with the file's name and the place:
/// the line while reading text, the byte while reading binary numbers.
class Cursor {
  public:
    /// Reads `text` from `begin` to `end`; both are kept by reference and must outlive the cursor.
    Cursor(std::string_view text, const std::string& name, std::size_t begin = 0,
           std::size_t end = std::string_view::npos);

    /// @throws lancet::Error "name: line 12: message" at the last item read.
    [[noreturn]] void fail(const std::string& message) const;
    /// The same with "byte 1234" for the place.
    [[noreturn]] void fail_at_byte(const std::string& message) const;

    const std::string& name() const { return name_; }
    std::size_t position() const { return at_; }
    std::size_t remaining() const { return text_.size() - at_; }
    std::string_view rest() const { return text_.substr(at_); }
    /// A cursor over a part of the same file; its places are those of the file.
    Cursor part(std::size_t begin, std::size_t end) const { return {text_, name_, begin, end}; }
    void move_to(std::size_t position) { at_ = position < text_.size() ? position : text_.size(); }
    /// Makes the present position the place that fail() names.
    void mark() { mark_ = at_; }

    /// Skips white space; true where nothing but white space was left.
    bool at_end();
    /// The next word, empty at the end; stays before it.
    std::string_view peek_word();
    /// The next word. Fails at the end.
    std::string_view word(const char* what);
    /// The rest of the line without its end; the cursor moves to the next line.
    std::string_view line();

    /// The next word as a finite number.
    double number(const char* what);
    std::int64_t integer(const char* what);
    /// An integer of the range of int32_t.
    std::int32_t small_integer(const char* what);
    /// A number of items that each take at least `bytes_each` bytes of what remains of the file: a count that the
    /// file cannot hold fails before memory is taken for it.
    std::size_t count(const char* what, std::size_t bytes_each);
    /// The check that count() makes.
    std::size_t checked_count(std::int64_t value, const char* what, std::size_t bytes_each) const;

    /// The next bytes as they are. Fails, naming the byte, if there are fewer.
    std::string_view bytes(std::size_t size, const char* what);
    /// A binary number.
    template <typename Value>
    Value binary(bool swap, const char* what) {
        Value value;
        std::memcpy(&value, bytes(sizeof(Value), what).data(), sizeof(Value));
        return swap ? byte_swapped(value) : value;
    }

  private:
    void skip_space();

    std::string_view text_;
    const std::string& name_;
    std::size_t at_;
    std::size_t mark_;
};

/// Reads a whole word as a finite number or an integer; false where it is none.
bool parse(std::string_view word, double& value);
bool parse(std::string_view word, std::int64_t& value);

/// The word in quotes, shortened and without control characters, for messages.
std::string in_quotes(std::string_view word);
/// Lower-case copy (ASCII).
std::string lower(std::string_view word);
/// Without white space at either end.
std::string_view trimmed(std::string_view text);

constexpr bool is_space(char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}

}  // namespace lancet::mesh::io
