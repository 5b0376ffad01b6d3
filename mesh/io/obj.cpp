// Wavefront OBJ: a statement a line; `\` at its end continues it.
#include <limits>
#include <string>

#include "lancet/mesh/io/surface_formats.hpp"

namespace lancet::mesh::io {

namespace {

/// The statement's line with what continues it.
std::string statement(Cursor& file) {
    std::string text;
    for (;;) {
        std::string_view line = file.line();
        const bool continues = !line.empty() && line.back() == '\\';
        if (continues) line.remove_suffix(1);
        text += line;
        if (!continues || file.remaining() == 0) return text;
        text += ' ';
    }
}

/// The word at the beginning, taken off.
std::string_view take_word(std::string_view& text) {
    text = trimmed(text);
    std::size_t end = 0;
    while (end < text.size() && !is_space(text[end])) ++end;
    const std::string_view word = text.substr(0, end);
    text.remove_prefix(end);
    return word;
}

/// A vertex of a face: its number from one on, or counted back from the last vertex so far, before any slash.
std::int32_t corner(const Cursor& file, std::string_view word, std::size_t vertices) {
    const std::string_view number = word.substr(0, word.find('/'));
    std::int64_t value = 0;
    if (!parse(number, value)) file.fail("expected a vertex number, but found " + in_quotes(word));
    const auto count = static_cast<std::int64_t>(vertices);
    const std::int64_t index = value > 0 ? value - 1 : count + value;
    if (value == 0 || value > count || index < 0) {
        file.fail("a face has vertex " + std::to_string(value) + "; there are " + std::to_string(count) + " so far");
    }
    return static_cast<std::int32_t>(index);
}

}  // namespace

TriangleMesh read_obj(Cursor& file) {
    TriangleMesh surface;
    std::vector<std::int32_t> corners;
    while (file.remaining() > 0) {
        const std::string text = statement(file);
        std::string_view rest = text;
        const std::string_view keyword = take_word(rest);
        if (keyword == "v") {
            Point& vertex = surface.vertices.emplace_back();
            for (double& value : vertex) {
                const std::string_view word = take_word(rest);
                if (!parse(word, value)) {
                    file.fail("expected a coordinate, a finite number, but found " + in_quotes(word));
                }
            }
            if (surface.vertices.size() > std::numeric_limits<std::int32_t>::max()) {
                file.fail("more vertices than 32-bit numbers count");
            }
        } else if (keyword == "f") {
            corners.clear();
            for (auto word = take_word(rest); !word.empty() && word.front() != '#'; word = take_word(rest)) {
                corners.push_back(corner(file, word, surface.vertices.size()));
            }
            if (corners.size() < 3) {
                file.fail("a face has " + std::to_string(corners.size()) + " vertices; expected at least 3");
            }
            add_polygon(surface, corners);
        } else if (keyword.find('\0') != std::string_view::npos) {
            file.fail("expected text; this is not a Wavefront file");
        }
    }
    return surface;
}

}  // namespace lancet::mesh::io
