#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "lancet/mesh/io/cursor.hpp"
#include "lancet/mesh/io/raw_mesh.hpp"

namespace lancet::mesh::io {

/// Numbers of a Gmsh section, as text or binary.
struct GmshStream {
    Cursor& cursor;
    bool binary = false;
    bool swap = false;

    std::int32_t integer(const char* what) {
        return binary ? cursor.binary<std::int32_t>(swap, what) : cursor.small_integer(what);
    }
    /// size_t in version 4.
    std::int64_t size(const char* what) {
        return binary ? cursor.binary<std::int64_t>(swap, what) : cursor.integer(what);
    }
    double real(const char* what);
    /// A count of version 4, checked against what remains of the file.
    std::size_t count(const char* what, std::size_t text_bytes_each, std::size_t binary_bytes_each);
    [[noreturn]] void fail(const std::string& message) const;
};

/// Collects what the versions of the format have in common.
class GmshBuilder {
  public:
    using Group = std::pair<int, int>;  // dimension, number

    /// Nodes are complete: their coordinates and their numbers in the file.
    void set_nodes(std::vector<Point> nodes, const std::vector<std::int64_t>& numbers, const Cursor& cursor);
    void name_group(Group group, std::string name) { names_[group] = std::move(name); }
    bool has_nodes() const { return has_nodes_; }

    /// @returns our number. Fails where there is no such node.
    std::int32_t node(std::int64_t number, const GmshStream& stream) const;
    /// `groups` are the numbers of physical groups; 0 means none.
    void add_element(int type, std::span<const std::int32_t> nodes, std::span<const std::int32_t> groups);
    /// The kind of an element type. Fails for unknown types.
    static const CellKind& kind(int type, const GmshStream& stream);

    void note(std::string text) { raw_.notes.push_back(std::move(text)); }
    RawMesh finish(const std::string& file);

  private:
    RawMesh raw_;
    NumberMap nodes_;
    OtherCells others_;
    std::map<Group, std::string> names_;
    std::map<Group, std::vector<std::int32_t>> members_;
    std::size_t in_several_groups_ = 0;
    bool has_nodes_ = false;
};

/// Each reads one section, from behind its opening line to before its closing word.
void read_gmsh_nodes_2(GmshStream stream, bool version_1, GmshBuilder& builder);
void read_gmsh_elements_1(GmshStream stream, GmshBuilder& builder);
void read_gmsh_elements_2(GmshStream stream, GmshBuilder& builder);

/// Physical groups of the entities of version 4.1, by dimension and number.
using GmshEntities = std::map<std::pair<int, int>, std::vector<std::int32_t>>;
void read_gmsh_entities_4(GmshStream stream, GmshEntities& entities);
void read_gmsh_nodes_4(GmshStream stream, GmshBuilder& builder);
void read_gmsh_elements_4(GmshStream stream, const GmshEntities& entities, GmshBuilder& builder);

}  // namespace lancet::mesh::io
