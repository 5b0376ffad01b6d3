// TetGen's .node and .ele files.
#include <cmath>
#include <limits>
#include <string>

#include "lancet/mesh/io/raw_mesh.hpp"

namespace lancet::mesh::io {

namespace {

/// The next line that holds anything, without its comment.
class Lines {
  public:
    explicit Lines(Cursor& cursor) : cursor_(cursor) {}

    /// Fails at the end of the file.
    Cursor next(const char* what) {
        while (cursor_.remaining() > 0) {
            const std::size_t begin = cursor_.position();
            const std::string_view line = cursor_.line();
            const std::string_view content = line.substr(0, line.find('#'));
            if (trimmed(content).empty()) continue;
            return cursor_.part(begin, begin + content.size());
        }
        cursor_.mark();
        cursor_.fail(std::string("the file ends where ") + what + " is expected");
    }

  private:
    Cursor& cursor_;
};

void expect_end(Cursor& line, const char* what) {
    if (!line.at_end())
        line.fail("expected the end of " + std::string(what) + ", but found " + in_quotes(line.peek_word()));
}

/// A number at the end of a header that may be left out.
std::int64_t optional_integer(Cursor& line, const char* what, std::int64_t most) {
    if (line.at_end()) return 0;
    const std::int64_t value = line.integer(what);
    if (value < 0 || value > most) {
        line.fail(std::string(what) + " is " + std::to_string(value) + "; expected 0 to " + std::to_string(most));
    }
    return value;
}

void read_nodes(Cursor& cursor, RawMesh& raw, NumberMap& map) {
    Lines lines(cursor);
    Cursor header = lines.next("the number of nodes");
    const std::int64_t announced = header.integer("the number of nodes");
    const std::size_t count = cursor.checked_count(announced, "the number of nodes", 8);
    if (const std::int64_t dimension = header.integer("the dimension"); dimension != 3) {
        header.fail("nodes of dimension " + std::to_string(dimension) + "; expected 3");
    }
    const std::int64_t attributes = optional_integer(header, "the number of attributes", 1000);
    const std::int64_t markers = optional_integer(header, "the number of boundary markers", 1);
    expect_end(header, "the header");

    std::vector<std::int64_t> numbers(count);
    raw.definition.nodes.resize(count);
    for (std::size_t n = 0; n < count; ++n) {
        Cursor line = lines.next("a node");
        numbers[n] = line.integer("a node number");
        for (double& value : raw.definition.nodes[n]) value = line.number("a coordinate");
        for (std::int64_t a = 0; a < attributes; ++a) line.number("an attribute");
        if (markers == 1) {
            const std::int64_t marker = line.integer("a boundary marker");
            if (marker != 0) {
                raw.definition.node_sets["marker_" + std::to_string(marker)].push_back(static_cast<std::int32_t>(n));
            }
        }
        expect_end(line, "the node");
    }
    map.build(numbers, cursor, "node");
}

std::int32_t region(Cursor& line) {
    const double value = line.number("a region attribute");
    if (value != std::floor(value) || std::abs(value) > std::numeric_limits<std::int32_t>::max()) {
        line.fail("a region attribute of " + std::to_string(value) + "; expected an integer of 32 bits");
    }
    return static_cast<std::int32_t>(value);
}

}  // namespace

RawMesh read_tetgen(Cursor& nodes, Cursor& elements) {
    RawMesh raw;
    NumberMap map;
    read_nodes(nodes, raw, map);

    Lines lines(elements);
    Cursor header = lines.next("the number of tetrahedra");
    const std::int64_t announced = header.integer("the number of tetrahedra");
    const std::size_t count = elements.checked_count(announced, "the number of tetrahedra", 10);
    const std::int64_t nodes_each = header.at_end() ? 4 : header.integer("the number of nodes of a tetrahedron");
    if (nodes_each != 4) {
        header.fail(std::to_string(announced) + " tetrahedra of " + std::to_string(nodes_each) +
                    " nodes: the only volume cells read are linear (4-node) tetrahedra");
    }
    const std::int64_t attributes = optional_integer(header, "the number of attributes", 1000);
    expect_end(header, "the header");
    raw.definition.tetrahedra.resize(count);
    for (Tetrahedron& t : raw.definition.tetrahedra) {
        Cursor line = lines.next("a tetrahedron");
        line.integer("an element number");
        for (std::int32_t& node : t) {
            const std::int64_t number = line.integer("a node of an element");
            node = map.find(number);
            if (node < 0) line.fail("an element names node " + std::to_string(number) + ", which is not in the file");
        }
        for (std::int64_t a = 0; a < attributes; ++a) {
            if (a == 0) raw.definition.regions.push_back(region(line));
            if (a > 0) line.number("an attribute");
        }
        expect_end(line, "the element");
    }
    return raw;
}

}  // namespace lancet::mesh::io
