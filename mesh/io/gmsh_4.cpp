// Entities, nodes and elements of Gmsh's format 4.1.
#include <array>
#include <cstdlib>
#include <limits>
#include <string>

#include "lancet/mesh/io/gmsh.hpp"

namespace lancet::mesh::io {

namespace {

int read_dimension(GmshStream& stream) {
    const std::int32_t dimension = stream.integer("the dimension of an entity");
    if (dimension < 0 || dimension > 3) {
        stream.fail("an entity of dimension " + std::to_string(dimension) + "; expected 0 to 3");
    }
    return dimension;
}

/// Checks the sum over blocks against the number at the beginning of the section.
void check_total(const GmshStream& stream, std::size_t found, std::size_t expected, const char* what) {
    if (found == expected) return;
    stream.fail("the blocks hold " + std::to_string(found) + ' ' + what + "; the section announced " +
                std::to_string(expected));
}

}  // namespace

void read_gmsh_entities_4(GmshStream stream, GmshEntities& entities) {
    std::array<std::size_t, 4> counts{};
    for (std::size_t& count : counts) count = stream.count("the number of entities", 10, 36);
    for (int dimension = 0; dimension < 4; ++dimension) {
        for (std::size_t e = 0; e < counts[static_cast<std::size_t>(dimension)]; ++e) {
            const std::int32_t number = stream.integer("the number of an entity");
            for (int value = 0; value < (dimension == 0 ? 3 : 6); ++value) stream.real("a bound of an entity");
            auto& groups = entities[{dimension, number}];
            const std::size_t group_count = stream.count("the number of physical groups", 2, 4);
            for (std::size_t g = 0; g < group_count; ++g) {
                const std::int32_t group = stream.integer("a physical group");
                if (group == std::numeric_limits<std::int32_t>::min()) stream.fail("a physical group out of range");
                // The sign tells the orientation.
                groups.push_back(std::abs(group));
            }
            if (dimension == 0) continue;
            const std::size_t bounds = stream.count("the number of bounding entities", 2, 4);
            for (std::size_t b = 0; b < bounds; ++b) stream.integer("a bounding entity");
        }
    }
}

void read_gmsh_nodes_4(GmshStream stream, GmshBuilder& builder) {
    const std::size_t blocks = stream.count("the number of blocks of nodes", 8, 20);
    const std::size_t total = stream.count("the number of nodes", 8, 32);
    stream.size("the lowest node number");
    stream.size("the highest node number");
    std::vector<Point> nodes;
    std::vector<std::int64_t> numbers;
    nodes.reserve(total);
    numbers.reserve(total);
    for (std::size_t b = 0; b < blocks; ++b) {
        const int dimension = read_dimension(stream);
        stream.integer("the number of an entity");
        const std::int32_t parametric = stream.integer("0 or 1 for parametric coordinates");
        if (parametric != 0 && parametric != 1) {
            stream.fail("a parametric flag of " + std::to_string(parametric) + "; expected 0 or 1");
        }
        const std::size_t count = stream.count("the number of nodes in a block", 8, 32);
        for (std::size_t n = 0; n < count; ++n) numbers.push_back(stream.size("a node number"));
        for (std::size_t n = 0; n < count; ++n) {
            Point& x = nodes.emplace_back();
            for (double& value : x) value = stream.real("a coordinate");
            for (int p = 0; p < parametric * dimension; ++p) stream.real("a parametric coordinate");
        }
    }
    check_total(stream, nodes.size(), total, "nodes");
    builder.set_nodes(std::move(nodes), numbers, stream.cursor);
}

void read_gmsh_elements_4(GmshStream stream, const GmshEntities& entities, GmshBuilder& builder) {
    const std::size_t blocks = stream.count("the number of blocks of elements", 8, 20);
    const std::size_t total = stream.count("the number of elements", 4, 16);
    stream.size("the lowest element number");
    stream.size("the highest element number");
    std::size_t found = 0;
    for (std::size_t b = 0; b < blocks; ++b) {
        const int dimension = read_dimension(stream);
        const std::int32_t entity = stream.integer("the number of an entity");
        const std::int32_t type = stream.integer("an element type");
        const CellKind& kind = GmshBuilder::kind(type, stream);
        if (kind.dimension != dimension) {
            stream.fail(std::string(kind.name) + " in an entity of dimension " + std::to_string(dimension));
        }
        const std::size_t count = stream.count("the number of elements in a block", 4, 16);
        std::span<const std::int32_t> groups;
        const auto known = entities.find({dimension, entity});
        if (known != entities.end()) groups = known->second;
        std::array<std::int32_t, 64> nodes{};
        const auto nodes_each = static_cast<std::size_t>(kind.nodes);
        for (std::size_t e = 0; e < count; ++e) {
            stream.size("an element number");
            for (std::size_t n = 0; n < nodes_each; ++n) {
                nodes[n] = builder.node(stream.size("a node of an element"), stream);
            }
            builder.add_element(type, std::span(nodes).first(nodes_each), groups);
        }
        found += count;
    }
    check_total(stream, found, total, "elements");
}

}  // namespace lancet::mesh::io
