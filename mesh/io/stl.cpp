// STL: triangles with their normals, which are not read, as text or as little-endian binary records.
#include <bit>
#include <cmath>

#include "lancet/mesh/io/surface_formats.hpp"

namespace lancet::mesh::io {

namespace {

constexpr std::size_t header_bytes = 80;
constexpr std::size_t record_bytes = 12 * sizeof(float) + 2;

/// A binary file says how long it is; some begin with `solid`, too.
bool is_binary(std::string_view content) {
    if (content.size() < header_bytes + 4) return false;
    std::uint32_t count = 0;
    std::memcpy(&count, content.data() + header_bytes, sizeof(count));
    if constexpr (std::endian::native == std::endian::big) count = byte_swapped(count);
    if (content.size() == header_bytes + 4 + count * record_bytes) return true;
    return lower(trimmed(content.substr(0, header_bytes)).substr(0, 5)) != "solid";
}

void add_triangle(TriangleMesh& surface, const std::array<Point, 3>& corners) {
    const auto first = static_cast<std::int32_t>(surface.vertices.size());
    surface.vertices.insert(surface.vertices.end(), corners.begin(), corners.end());
    surface.triangles.push_back({first, first + 1, first + 2});
}

/// 3 vertices a triangle have to be counted by 32-bit numbers.
constexpr std::size_t most_triangles = 0x7fffffff / 3;

TriangleMesh read_binary(Cursor& file) {
    TriangleMesh surface;
    const bool swap = std::endian::native == std::endian::big;
    file.bytes(header_bytes, "header");
    const auto triangles = file.binary<std::uint32_t>(swap, "number of triangles");
    if (triangles > file.remaining() / record_bytes || triangles > most_triangles) {
        file.fail_at_byte("the number of triangles is " + std::to_string(triangles) +
                          ", but the rest of the file holds at most " +
                          std::to_string(file.remaining() / record_bytes));
    }
    for (std::uint32_t t = 0; t < triangles; ++t) {
        file.bytes(3 * sizeof(float), "normal");
        std::array<Point, 3> corners{};
        for (Point& corner : corners) {
            for (double& value : corner) {
                value = static_cast<double>(file.binary<float>(swap, "coordinate"));
                if (!std::isfinite(value)) {
                    file.fail_at_byte("a coordinate of triangle " + std::to_string(t) + " is not finite");
                }
            }
        }
        file.bytes(2, "attribute");
        add_triangle(surface, corners);
    }
    return surface;
}

void expect(Cursor& file, const char* keyword) {
    const std::string_view found = file.word(keyword);
    if (lower(found) != keyword) file.fail(std::string("expected ") + keyword + ", but found " + in_quotes(found));
}

TriangleMesh read_text(Cursor& file) {
    TriangleMesh surface;
    expect(file, "solid");
    file.line();  // its name
    for (;;) {
        const std::string keyword = lower(file.word("facet or endsolid"));
        if (keyword == "endsolid") {
            file.line();
            if (file.at_end()) return surface;
            expect(file, "solid");
            file.line();
            continue;
        }
        if (keyword != "facet") file.fail("expected facet or endsolid, but found " + in_quotes(keyword));
        expect(file, "normal");
        // Normals of triangles without an area are often not numbers.
        for (int axis = 0; axis < 3; ++axis) file.word("a component of the normal");
        expect(file, "outer");
        expect(file, "loop");
        std::array<Point, 3> corners{};
        for (Point& corner : corners) {
            expect(file, "vertex");
            for (double& value : corner) value = file.number("a coordinate");
        }
        expect(file, "endloop");
        expect(file, "endfacet");
        if (surface.triangles.size() >= most_triangles) file.fail("more vertices than 32-bit numbers count");
        add_triangle(surface, corners);
    }
}

}  // namespace

TriangleMesh read_stl(Cursor& file) {
    return merged(is_binary(file.rest()) ? read_binary(file) : read_text(file));
}

}  // namespace lancet::mesh::io
