// PLY: a header that describes elements by their properties, then the elements as text or binary.
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "lancet/mesh/io/surface_formats.hpp"

namespace lancet::mesh::io {

namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::optional<Type> type_of(std::string_view name) {
    if (name == "char" || name == "int8") return Type::int8;
    if (name == "uchar" || name == "uint8") return Type::uint8;
    if (name == "short" || name == "int16") return Type::int16;
    if (name == "ushort" || name == "uint16") return Type::uint16;
    if (name == "int" || name == "int32") return Type::int32;
    if (name == "uint" || name == "uint32") return Type::uint32;
    if (name == "float" || name == "float32") return Type::float32;
    if (name == "double" || name == "float64") return Type::float64;
    return std::nullopt;
}

struct Property {
    std::string name{};
    Type type = Type::float32;
    std::optional<Type> count{};  ///< of a list
};

struct Element {
    std::string name{};
    std::int64_t count = 0;
    std::vector<Property> properties{};
};

struct Header {
    bool is_text = true;
    bool swap = false;
    std::vector<Element> elements{};
};

/// Values of a file's body in its own encoding.
class Values {
  public:
    Values(Cursor& file, const Header& header) : file_(file), header_(header) {}

    /// Not checked to be finite, nor is what lies in an integer's range known to be whole.
    double next(Type type, const char* what) {
        if (header_.is_text) return next_text(type, what);
        switch (type) {
            case Type::int8:
                return binary<std::int8_t>(what);
            case Type::uint8:
                return binary<std::uint8_t>(what);
            case Type::int16:
                return binary<std::int16_t>(what);
            case Type::uint16:
                return binary<std::uint16_t>(what);
            case Type::int32:
                return binary<std::int32_t>(what);
            case Type::uint32:
                return binary<std::uint32_t>(what);
            case Type::float32:
                return binary<float>(what);
            case Type::float64:
                return binary<double>(what);
        }
        file_.fail("no such type");
    }

    [[noreturn]] void fail(const std::string& message) const {
        if (header_.is_text) file_.fail(message);
        file_.fail_at_byte(message);
    }

  private:
    double next_text(Type type, const char* what) {
        if (type == Type::float32 || type == Type::float64) return file_.number(what);
        return static_cast<double>(file_.integer(what));
    }
    template <class Value>
    double binary(const char* what) {
        return static_cast<double>(file_.binary<Value>(header_.swap, what));
    }

    Cursor& file_;
    const Header& header_;
};

Type read_type(Cursor& file) {
    const std::string_view word = file.word("a type");
    const std::optional<Type> type = type_of(word);
    if (!type) file.fail("expected a type such as float or uchar, but found " + in_quotes(word));
    return *type;
}

Header read_header(Cursor& file) {
    if (file.line() != "ply") file.fail("expected ply; this is not a PLY file");
    Header header;
    bool has_format = false;
    for (;;) {
        const std::string_view keyword = file.word("end_header");
        if (keyword == "end_header") break;
        if (keyword == "comment" || keyword == "obj_info") {
            file.line();
        } else if (keyword == "format") {
            const std::string_view format = file.word("a format");
            const bool is_little = format == "binary_little_endian", is_big = format == "binary_big_endian";
            if (!is_little && !is_big && format != "ascii") {
                file.fail("expected ascii, binary_little_endian or binary_big_endian, but found " + in_quotes(format));
            }
            header.is_text = !is_little && !is_big;
            header.swap = std::endian::native == std::endian::little ? is_big : is_little;
            has_format = true;
            file.word("a version");
        } else if (keyword == "element") {
            Element& element = header.elements.emplace_back();
            element.name = file.word("an element's name");
            element.count = file.integer("a number of elements");
            if (element.count < 0) file.fail("the number of elements is negative: " + std::to_string(element.count));
        } else if (keyword == "property") {
            if (header.elements.empty()) file.fail("a property comes before the first element");
            Property property;
            if (file.peek_word() == "list") {
                file.word("list");
                property.count = read_type(file);
                if (*property.count == Type::float32 || *property.count == Type::float64) {
                    file.fail("the length of a list is not an integer");
                }
            }
            property.type = read_type(file);
            property.name = file.word("a property's name");
            header.elements.back().properties.push_back(std::move(property));
        } else {
            file.fail("expected a line of a PLY header, but found " + in_quotes(keyword));
        }
    }
    file.line();  // up to and with the end of the line
    if (!has_format) file.fail("the header has no format");
    return header;
}

void check_room(const Cursor& file, const Element& element) {
    // Each value takes a byte at least, in either encoding; without properties nothing is stored.
    if (element.properties.empty() && element.count > 0) {
        file.fail("element " + in_quotes(element.name) + " has no properties");
    }
    file.checked_count(element.count, "a number of elements", 1);
    if (element.count > std::numeric_limits<std::int32_t>::max()) {
        file.fail("more elements than 32-bit numbers count");
    }
}

/// Reads an element's lists and passes each property's values on: use(property, its values).
template <class Use>
void for_each_property(Values& values, const Cursor& file, const Element& element, std::vector<double>& list,
                       const Use& use) {
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const Property& property = element.properties[p];
        std::int64_t count = 1;
        if (property.count) {
            const double length = values.next(*property.count, "the length of a list");
            // What is compared is whole: the type of a length is an integer one.
            if (!(length >= 0) || length > static_cast<double>(file.remaining())) {
                values.fail("a list's length is " + std::to_string(static_cast<std::int64_t>(length)) +
                            ", but the rest of the file is not that long");
            }
            count = static_cast<std::int64_t>(length);
        }
        list.clear();
        for (std::int64_t k = 0; k < count; ++k) list.push_back(values.next(property.type, "a value"));
        use(p, list);
    }
}

void read_vertices(Values& values, const Cursor& file, const Element& element, TriangleMesh& surface) {
    std::array<std::size_t, 3> axes{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::string name(1, "xyz"[axis]);
        std::size_t p = 0;
        while (p < element.properties.size() && element.properties[p].name != name) ++p;
        if (p == element.properties.size() || element.properties[p].count) {
            file.fail("the vertices have no property " + name);
        }
        axes[axis] = p;
    }
    std::vector<double> list;
    for (std::int64_t v = 0; v < element.count; ++v) {
        Point vertex{};
        for_each_property(values, file, element, list, [&](std::size_t p, const std::vector<double>& found) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                if (axes[axis] == p) vertex[axis] = found.front();
            }
        });
        for (const double value : vertex) {
            if (!std::isfinite(value)) values.fail("vertex " + std::to_string(v) + " is not finite");
        }
        surface.vertices.push_back(vertex);
    }
}

void read_faces(Values& values, const Cursor& file, const Element& element, std::int64_t vertices,
                TriangleMesh& surface) {
    std::size_t indices = 0;
    const auto is_indices = [](const Property& p) {
        return p.count && (p.name == "vertex_indices" || p.name == "vertex_index");
    };
    while (indices < element.properties.size() && !is_indices(element.properties[indices])) ++indices;
    if (indices == element.properties.size()) file.fail("the faces have no list vertex_indices");
    const Type type = element.properties[indices].type;
    if (type == Type::float32 || type == Type::float64) file.fail("the numbers of vertices are not integers");
    std::vector<double> list;
    std::vector<std::int32_t> corners;
    for (std::int64_t f = 0; f < element.count; ++f) {
        for_each_property(values, file, element, list, [&](std::size_t p, const std::vector<double>& found) {
            if (p != indices) return;
            if (found.size() < 3) {
                values.fail("face " + std::to_string(f) + " has " + std::to_string(found.size()) +
                            " vertices; expected at least 3");
            }
            corners.clear();
            for (const double vertex : found) {
                if (!(vertex >= 0) || vertex >= static_cast<double>(vertices)) {
                    values.fail("face " + std::to_string(f) + " has vertex " +
                                std::to_string(static_cast<std::int64_t>(vertex)) + "; there are " +
                                std::to_string(vertices));
                }
                corners.push_back(static_cast<std::int32_t>(vertex));
            }
            add_polygon(surface, corners);
        });
    }
}

}  // namespace

TriangleMesh read_ply(Cursor& file) {
    const Header header = read_header(file);
    std::int64_t vertices = -1;
    for (const Element& element : header.elements) {
        if (element.name == "vertex") vertices = element.count;
    }
    if (vertices < 0) file.fail("the header has no element vertex");
    TriangleMesh surface;
    Values values(file, header);
    std::vector<double> list;
    for (const Element& element : header.elements) {
        check_room(file, element);
        if (element.name == "vertex" && surface.vertices.empty()) {
            read_vertices(values, file, element, surface);
        } else if (element.name == "face") {
            read_faces(values, file, element, vertices, surface);
        } else {
            for (std::int64_t k = 0; k < element.count; ++k) {
                for_each_property(values, file, element, list, [](std::size_t, const std::vector<double>&) {});
            }
        }
    }
    return surface;
}

}  // namespace lancet::mesh::io
