#include "lancet/mesh/io/cursor.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "lancet/kernels/error.hpp"

namespace lancet::mesh::io {

Cursor::Cursor(std::string_view text, const std::string& name, std::size_t begin, std::size_t end)
    : text_(text.substr(0, end)), name_(name), at_(std::min(begin, text_.size())), mark_(at_) {}

void Cursor::fail(const std::string& message) const {
    const auto lines = std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(mark_), '\n');
    throw Error(name_ + ": line " + std::to_string(lines + 1) + ": " + message);
}

void Cursor::fail_at_byte(const std::string& message) const {
    throw Error(name_ + ": byte " + std::to_string(mark_) + ": " + message);
}

void Cursor::skip_space() {
    while (at_ < text_.size() && is_space(text_[at_])) ++at_;
}

bool Cursor::at_end() {
    skip_space();
    return at_ == text_.size();
}

std::string_view Cursor::peek_word() {
    skip_space();
    mark_ = at_;
    std::size_t end = at_;
    while (end < text_.size() && !is_space(text_[end])) ++end;
    return text_.substr(at_, end - at_);
}

std::string_view Cursor::word(const char* what) {
    const std::string_view result = peek_word();
    if (result.empty()) fail(std::string("the file ends where ") + what + " is expected");
    at_ += result.size();
    return result;
}

std::string_view Cursor::line() {
    mark_ = at_;
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view result = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    if (!result.empty() && result.back() == '\r') result.remove_suffix(1);
    return result;
}

double Cursor::number(const char* what) {
    const std::string_view found = word(what);
    double value = 0;
    if (!parse(found, value))
        fail(std::string("expected ") + what + ", a finite number, but found " + in_quotes(found));
    return value;
}

std::int64_t Cursor::integer(const char* what) {
    const std::string_view found = word(what);
    std::int64_t value = 0;
    if (!parse(found, value)) fail(std::string("expected ") + what + ", an integer, but found " + in_quotes(found));
    return value;
}

std::int32_t Cursor::small_integer(const char* what) {
    const std::int64_t value = integer(what);
    using Limits = std::numeric_limits<std::int32_t>;
    if (value < Limits::min() || value > Limits::max()) {
        fail(std::string(what) + ' ' + std::to_string(value) + " does not fit into 32 bits");
    }
    return static_cast<std::int32_t>(value);
}

std::size_t Cursor::count(const char* what, std::size_t bytes_each) {
    return checked_count(integer(what), what, bytes_each);
}

std::size_t Cursor::checked_count(std::int64_t value, const char* what, std::size_t bytes_each) const {
    if (value < 0) fail(std::string(what) + " is negative: " + std::to_string(value));
    // The last item may go without its separator.
    const std::size_t most = (remaining() + 1) / bytes_each;
    if (static_cast<std::uint64_t>(value) > most) {
        fail(std::string(what) + " is " + std::to_string(value) + ", but the rest of the file holds at most " +
             std::to_string(most));
    }
    return static_cast<std::size_t>(value);
}

std::string_view Cursor::bytes(std::size_t size, const char* what) {
    mark_ = at_;
    if (size > remaining()) {
        fail_at_byte(std::string("the file ends where ") + std::to_string(size) + " bytes of " + what +
                     " are expected");
    }
    at_ += size;
    return text_.substr(mark_, size);
}

bool parse(std::string_view word, double& value) {
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error == std::errc::result_out_of_range && end == word.data() + word.size()) {
        // Too small is zero, too large is not finite; from_chars does not say which.
        value = std::strtod(std::string(word).c_str(), nullptr);
        return std::isfinite(value);
    }
    return error == std::errc() && end == word.data() + word.size() && std::isfinite(value);
}

bool parse(std::string_view word, std::int64_t& value) {
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc() && end == word.data() + word.size();
}

std::string in_quotes(std::string_view word) {
    constexpr std::size_t longest = 40;
    std::string result = "'";
    for (const char c : word.substr(0, longest)) result += c >= ' ' && c < 127 ? c : '?';
    return result + (word.size() > longest ? "...'" : "'");
}

std::string lower(std::string_view word) {
    std::string result(word);
    for (char& c : result) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return result;
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
    return text;
}

}  // namespace lancet::mesh::io
