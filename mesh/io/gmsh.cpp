#include "lancet/mesh/io/gmsh.hpp"

#include <array>
#include <cmath>
#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::mesh::io {

namespace {

constexpr int tetrahedron_type = 4;

/// Element types of the format, by number.
constexpr std::array<CellKind, 32> kinds{{{"", 0, 0},
                                          {"lines", 1, 2},
                                          {"triangles", 2, 3},
                                          {"quadrangles", 2, 4},
                                          {"tetrahedra", 3, 4},
                                          {"hexahedra", 3, 8},
                                          {"prisms", 3, 6},
                                          {"pyramids", 3, 5},
                                          {"3-node lines", 1, 3},
                                          {"6-node triangles", 2, 6},
                                          {"9-node quadrangles", 2, 9},
                                          {"10-node tetrahedra", 3, 10},
                                          {"27-node hexahedra", 3, 27},
                                          {"18-node prisms", 3, 18},
                                          {"14-node pyramids", 3, 14},
                                          {"points", 0, 1},
                                          {"8-node quadrangles", 2, 8},
                                          {"20-node hexahedra", 3, 20},
                                          {"15-node prisms", 3, 15},
                                          {"13-node pyramids", 3, 13},
                                          {"9-node triangles", 2, 9},
                                          {"10-node triangles", 2, 10},
                                          {"12-node triangles", 2, 12},
                                          {"15-node triangles", 2, 15},
                                          {"15-node triangles", 2, 15},
                                          {"21-node triangles", 2, 21},
                                          {"4-node lines", 1, 4},
                                          {"5-node lines", 1, 5},
                                          {"6-node lines", 1, 6},
                                          {"20-node tetrahedra", 3, 20},
                                          {"35-node tetrahedra", 3, 35},
                                          {"56-node tetrahedra", 3, 56}}};

struct Header {
    int version = 1;  // 1, 2 or 4
    bool binary = false;
    bool swap = false;
};

/// $MeshFormat: version, 0 for text or 1 for binary, size of a real number; the integer 1 if binary.
Header read_header(Cursor& cursor) {
    Header header;
    const std::string_view version = cursor.word("the version of the format");
    if (version == "4.1") {
        header.version = 4;
    } else if (version == "2" || version == "2.0" || version == "2.1" || version == "2.2") {
        header.version = 2;
    } else {
        cursor.fail("Gmsh format version " + in_quotes(version) + "; expected 1 ($NOD), 2, 2.1, 2.2 or 4.1");
    }
    const std::int32_t type = cursor.small_integer("0 for text or 1 for binary");
    if (type != 0 && type != 1) cursor.fail("file type " + std::to_string(type) + "; expected 0 or 1");
    const std::int32_t size = cursor.small_integer("the size of a real number");
    if (size != 8) cursor.fail("real numbers of " + std::to_string(size) + " bytes; expected 8");
    cursor.line();
    if (type == 1) {
        header.binary = true;
        const auto one = cursor.binary<std::int32_t>(false, "the integer 1 that shows the byte order");
        header.swap = byte_swapped(one) == 1;
        if (one != 1 && !header.swap) {
            cursor.fail_at_byte("the integer 1 that shows the byte order is " + std::to_string(one));
        }
    }
    return header;
}

void read_names(Cursor& cursor, GmshBuilder& builder) {
    // The shortest line is `3 1 ""`.
    const std::size_t count = cursor.count("the number of physical names", 6);
    for (std::size_t n = 0; n < count; ++n) {
        const std::int32_t dimension = cursor.small_integer("the dimension of a physical group");
        const std::int32_t number = cursor.small_integer("the number of a physical group");
        const std::string_view name = trimmed(cursor.line());
        if (name.size() < 2 || name.front() != '"' || name.back() != '"') {
            cursor.fail("expected the name of a physical group in quotes, but found " + in_quotes(name));
        }
        builder.name_group({dimension, number}, std::string(name.substr(1, name.size() - 2)));
    }
}

void expect(Cursor& cursor, const std::string& closing) {
    const std::string_view found = cursor.word(closing.c_str());
    if (found != closing) cursor.fail("expected " + closing + ", but found " + in_quotes(found));
}

void skip_section(Cursor& cursor, const std::string& closing) {
    const std::size_t place = cursor.rest().find(closing);
    if (place == std::string_view::npos) cursor.fail("the file ends before " + closing);
    cursor.move_to(cursor.position() + place + closing.size());
}

}  // namespace

double GmshStream::real(const char* what) {
    if (!binary) return cursor.number(what);
    const auto value = cursor.binary<double>(swap, what);
    if (!std::isfinite(value)) cursor.fail_at_byte(std::string(what) + " is not a finite number");
    return value;
}

std::size_t GmshStream::count(const char* what, std::size_t text_bytes_each, std::size_t binary_bytes_each) {
    const std::int64_t value = size(what);
    return cursor.checked_count(value, what, binary ? binary_bytes_each : text_bytes_each);
}

void GmshStream::fail(const std::string& message) const {
    if (binary) cursor.fail_at_byte(message);
    cursor.fail(message);
}

void GmshBuilder::set_nodes(std::vector<Point> nodes, const std::vector<std::int64_t>& numbers, const Cursor& cursor) {
    if (has_nodes_) cursor.fail("the file holds nodes twice");
    raw_.definition.nodes = std::move(nodes);
    nodes_.build(numbers, cursor, "node");
    has_nodes_ = true;
}

std::int32_t GmshBuilder::node(std::int64_t number, const GmshStream& stream) const {
    const std::int32_t found = nodes_.find(number);
    if (found < 0) stream.fail("an element names node " + std::to_string(number) + ", which is not in the file");
    return found;
}

const CellKind& GmshBuilder::kind(int type, const GmshStream& stream) {
    if (type < 1 || type >= static_cast<int>(kinds.size())) {
        stream.fail("element type " + std::to_string(type) + " is not known; expected 1 to 31");
    }
    return kinds[static_cast<std::size_t>(type)];
}

void GmshBuilder::add_element(int type, std::span<const std::int32_t> nodes, std::span<const std::int32_t> groups) {
    if (type == tetrahedron_type) {
        raw_.definition.tetrahedra.push_back({nodes[0], nodes[1], nodes[2], nodes[3]});
        raw_.definition.regions.push_back(groups.empty() ? 0 : groups.front());
        if (groups.size() > 1) ++in_several_groups_;
        return;
    }
    const CellKind& kind = kinds[static_cast<std::size_t>(type)];
    others_.add(kind);
    if (kind.dimension == 3) return;
    for (const std::int32_t group : groups) {
        if (group == 0) continue;
        auto& members = members_[{kind.dimension, group}];
        members.insert(members.end(), nodes.begin(), nodes.end());
    }
}

RawMesh GmshBuilder::finish(const std::string& file) {
    others_.report(file, raw_.notes);
    for (auto& [group, members] : members_) {
        const auto named = names_.find(group);
        const std::string name = named != names_.end()
                                     ? named->second
                                     : "physical_" + std::to_string(group.first) + "_" + std::to_string(group.second);
        auto& set = raw_.definition.node_sets[name];
        set.insert(set.end(), members.begin(), members.end());
    }
    for (const auto& [group, name] : names_) {
        if (group.first == 3) raw_.definition.region_names[group.second] = name;
    }
    if (in_several_groups_ > 0) {
        raw_.notes.push_back(std::to_string(in_several_groups_) +
                             " elements are in several physical groups; the first one became their region");
    }
    return std::move(raw_);
}

RawMesh read_gmsh(Cursor& cursor) {
    GmshBuilder builder;
    Header header;
    GmshEntities entities;
    bool has_header = false;
    bool has_elements = false;
    if (cursor.rest().starts_with("\xEF\xBB\xBF")) cursor.move_to(3);
    while (!cursor.at_end()) {
        const std::string_view opening = cursor.word("the name of a section");
        if (opening.size() < 2 || opening.front() != '$') {
            cursor.fail("expected a section ($Name), but found " + in_quotes(opening));
        }
        const std::string section(opening.substr(1));
        const bool old = section == "NOD" || section == "ELM";
        const bool nodes = section == "Nodes" || section == "NOD";
        const bool elements = section == "Elements" || section == "ELM";
        std::string closing = old ? "$END" : "$End";
        closing += section;
        GmshStream stream{cursor, header.binary, header.swap};
        if ((nodes || elements) && old == has_header) {
            cursor.fail(old ? "a section of version 1 in a file with $MeshFormat"
                            : "no $MeshFormat before $" + section);
        }
        if (elements && !builder.has_nodes()) cursor.fail("elements before the nodes");
        // The line ends here for what follows in binary.
        cursor.line();
        if (section == "MeshFormat") {
            if (has_header) cursor.fail("the file holds $MeshFormat twice");
            header = read_header(cursor);
            has_header = true;
        } else if (section == "PhysicalNames") {
            read_names(cursor, builder);
        } else if (section == "Entities" && header.version == 4) {
            read_gmsh_entities_4(stream, entities);
        } else if (nodes) {
            if (header.version == 4) read_gmsh_nodes_4(stream, builder);
            if (header.version != 4) read_gmsh_nodes_2(stream, old, builder);
        } else if (elements) {
            has_elements = true;
            if (header.version == 4) read_gmsh_elements_4(stream, entities, builder);
            if (header.version == 2) read_gmsh_elements_2(stream, builder);
            if (header.version == 1) read_gmsh_elements_1(stream, builder);
        } else {
            if (section == "PartitionedEntities") {
                builder.note("partitions are not read: their elements are in region 0");
            }
            skip_section(cursor, closing);
            continue;
        }
        expect(cursor, closing);
    }
    if (!has_elements) cursor.fail("the file ends without elements");
    return builder.finish(cursor.name());
}

}  // namespace lancet::mesh::io
