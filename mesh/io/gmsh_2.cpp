// Nodes and elements of Gmsh's formats 1 and 2.
#include <array>
#include <string>

#include "lancet/mesh/io/gmsh.hpp"

namespace lancet::mesh::io {

namespace {

/// Reads the nodes of one element and hands it on.
void read_element(GmshStream& stream, int type, const CellKind& kind, std::int32_t group, GmshBuilder& builder) {
    std::array<std::int32_t, 64> nodes{};
    const auto count = static_cast<std::size_t>(kind.nodes);
    for (std::size_t n = 0; n < count; ++n) {
        nodes[n] = builder.node(stream.integer("a node of an element"), stream);
    }
    builder.add_element(type, std::span(nodes).first(count), std::span(&group, group == 0 ? 0 : 1));
}

void read_binary_elements(GmshStream stream, std::size_t count, GmshBuilder& builder) {
    for (std::size_t done = 0; done < count;) {
        const std::int32_t type = stream.integer("an element type");
        const CellKind& kind = GmshBuilder::kind(type, stream);
        const std::int32_t block = stream.integer("the number of elements in a block");
        const std::int32_t tags = stream.integer("the number of tags");
        if (block < 1 || static_cast<std::size_t>(block) > count - done) {
            stream.fail("a block of " + std::to_string(block) + " elements; expected 1 to " +
                        std::to_string(count - done));
        }
        if (tags < 0 || tags > 1000) stream.fail(std::to_string(tags) + " tags; expected 0 to 1000");
        for (std::int32_t e = 0; e < block; ++e) {
            stream.integer("an element number");
            std::int32_t group = 0;
            for (std::int32_t tag = 0; tag < tags; ++tag) {
                const std::int32_t value = stream.integer("a tag");
                if (tag == 0) group = value;
            }
            read_element(stream, type, kind, group, builder);
        }
        done += static_cast<std::size_t>(block);
    }
}

}  // namespace

void read_gmsh_nodes_2(GmshStream stream, bool version_1, GmshBuilder& builder) {
    Cursor& cursor = stream.cursor;
    const bool binary = stream.binary && !version_1;
    const std::size_t count = cursor.count("the number of nodes", binary ? 28 : 8);
    if (binary) cursor.line();
    std::vector<Point> nodes(count);
    std::vector<std::int64_t> numbers(count);
    for (std::size_t n = 0; n < count; ++n) {
        numbers[n] = stream.integer("a node number");
        for (double& value : nodes[n]) value = stream.real("a coordinate");
    }
    builder.set_nodes(std::move(nodes), numbers, cursor);
}

void read_gmsh_elements_1(GmshStream stream, GmshBuilder& builder) {
    Cursor& cursor = stream.cursor;
    const std::size_t count = cursor.count("the number of elements", 12);
    for (std::size_t e = 0; e < count; ++e) {
        cursor.integer("an element number");
        const std::int32_t type = cursor.small_integer("an element type");
        const CellKind& kind = GmshBuilder::kind(type, stream);
        const std::int32_t group = cursor.small_integer("a physical region");
        cursor.integer("an elementary region");
        const std::int64_t nodes = cursor.integer("the number of nodes of an element");
        if (nodes != kind.nodes) {
            cursor.fail("an element of type " + std::to_string(type) + " with " + std::to_string(nodes) +
                        " nodes; expected " + std::to_string(kind.nodes));
        }
        read_element(stream, type, kind, group, builder);
    }
}

void read_gmsh_elements_2(GmshStream stream, GmshBuilder& builder) {
    Cursor& cursor = stream.cursor;
    const std::size_t count = cursor.count("the number of elements", 8);
    if (stream.binary) {
        cursor.line();
        read_binary_elements(stream, count, builder);
        return;
    }
    for (std::size_t e = 0; e < count; ++e) {
        cursor.integer("an element number");
        const std::int32_t type = cursor.small_integer("an element type");
        const CellKind& kind = GmshBuilder::kind(type, stream);
        const std::size_t tags = cursor.count("the number of tags", 2);
        std::int32_t group = 0;
        for (std::size_t tag = 0; tag < tags; ++tag) {
            const std::int32_t value = cursor.small_integer("a tag");
            if (tag == 0) group = value;
        }
        read_element(stream, type, kind, group, builder);
    }
}

}  // namespace lancet::mesh::io
