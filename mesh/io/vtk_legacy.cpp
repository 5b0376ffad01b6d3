// VTK's legacy format, unstructured grids.
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "lancet/mesh/io/raw_mesh.hpp"
#include "lancet/mesh/io/vtk_cells.hpp"

namespace lancet::mesh::io {

namespace {

enum class Scalar { u8, i8, u16, i16, u32, i32, u64, i64, f32, f64 };

std::optional<Scalar> scalar_of(const std::string& name) {
    if (name == "unsigned_char") return Scalar::u8;
    if (name == "char" || name == "signed_char") return Scalar::i8;
    if (name == "unsigned_short") return Scalar::u16;
    if (name == "short") return Scalar::i16;
    if (name == "unsigned_int") return Scalar::u32;
    if (name == "int" || name == "vtkidtype") return Scalar::i32;
    if (name == "unsigned_long" || name == "vtktypeuint64") return Scalar::u64;
    if (name == "long" || name == "vtktypeint64") return Scalar::i64;
    if (name == "float") return Scalar::f32;
    if (name == "double") return Scalar::f64;
    return std::nullopt;
}

std::size_t size_of(Scalar scalar) {
    switch (scalar) {
        case Scalar::u8:
        case Scalar::i8:
            return 1;
        case Scalar::u16:
        case Scalar::i16:
            return 2;
        case Scalar::u32:
        case Scalar::i32:
        case Scalar::f32:
            return 4;
        default:
            return 8;
    }
}

class Reader {
  public:
    explicit Reader(Cursor& cursor) : cursor_(cursor) {}

    RawMesh read() {
        read_header();
        while (!cursor_.at_end() && !stopped_) {
            const std::string keyword = lower(cursor_.word("a keyword"));
            if (keyword == "points") {
                read_points();
            } else if (keyword == "cells") {
                read_cells();
            } else if (keyword == "cell_types") {
                read_types();
            } else if (keyword == "cell_data" || keyword == "point_data") {
                read_data_header(keyword == "cell_data");
            } else if (keyword == "metadata") {
                cursor_.line();
                while (cursor_.remaining() > 0 && !trimmed(cursor_.line()).empty()) {
                }
            } else {
                read_attribute(keyword);
            }
        }
        cursor_.mark();
        if (!has_points_ || !has_cells_ || !has_types_) {
            cursor_.fail("the file ends without POINTS, CELLS or CELL_TYPES");
        }
        if (cells_.types.size() != cells_.ends.size()) {
            cursor_.fail(std::to_string(cells_.types.size()) + " cell types for " + std::to_string(cells_.ends.size()) +
                         " cells");
        }
        cursor_.move_to(cells_place_);
        cursor_.mark();
        OtherCells others;
        const auto taken = append_vtk_cells(cells_, 0, raw_.definition.nodes.size(), cursor_, raw_, others);
        others.report(cursor_.name(), raw_.notes);
        if (!regions_.empty() && !set_regions(regions_, taken, raw_)) {
            raw_.notes.push_back("the regions are not integers of 32 bits; all elements are in region 0");
        }
        return std::move(raw_);
    }

  private:
    void read_header() {
        if (!lower(cursor_.line()).starts_with("# vtk datafile version")) {
            cursor_.fail("expected '# vtk DataFile Version'");
        }
        cursor_.line();
        const std::string coding = lower(cursor_.word("ASCII or BINARY"));
        if (coding != "ascii" && coding != "binary")
            cursor_.fail("expected ASCII or BINARY, but found " + in_quotes(coding));
        binary_ = coding == "binary";
        if (lower(cursor_.word("DATASET")) != "dataset") cursor_.fail("expected DATASET");
        const std::string_view kind = cursor_.word("the kind of data set");
        if (lower(kind) != "unstructured_grid") {
            cursor_.fail("a data set of the kind " + in_quotes(kind) + "; expected UNSTRUCTURED_GRID");
        }
    }

    /// Values of a type that was just read at the end of a line.
    template <typename Value>
    std::vector<Value> values(Scalar scalar, std::size_t count, const char* what) {
        std::vector<Value> result;
        const auto announced = static_cast<std::int64_t>(count);
        if (!binary_) {
            result.resize(cursor_.checked_count(announced, what, 2));
            for (Value& value : result) {
                if constexpr (std::is_same_v<Value, double>) value = cursor_.number(what);
                if constexpr (!std::is_same_v<Value, double>) value = cursor_.integer(what);
            }
            return result;
        }
        cursor_.line();
        result.resize(cursor_.checked_count(announced, what, size_of(scalar)));
        for (Value& value : result) value = binary_value<Value>(scalar, what);
        return result;
    }

    /// Numbers are stored with the highest byte first.
    template <typename Value>
    Value binary_value(Scalar scalar, const char* what) {
        constexpr bool swap = std::endian::native == std::endian::little;
        const auto as = [&]<typename Stored>(Stored) { return static_cast<Value>(cursor_.binary<Stored>(swap, what)); };
        switch (scalar) {
            case Scalar::u8:
                return as(std::uint8_t{});
            case Scalar::i8:
                return as(std::int8_t{});
            case Scalar::u16:
                return as(std::uint16_t{});
            case Scalar::i16:
                return as(std::int16_t{});
            case Scalar::u32:
                return as(std::uint32_t{});
            case Scalar::i32:
                return as(std::int32_t{});
            case Scalar::u64:
                return as(std::uint64_t{});
            case Scalar::i64:
                return as(std::int64_t{});
            case Scalar::f32:
                return as_real<Value>(cursor_.binary<float>(swap, what), what);
            case Scalar::f64:
                break;
        }
        return as_real<Value>(cursor_.binary<double>(swap, what), what);
    }

    template <typename Value>
    Value as_real(double value, const char* what) {
        if constexpr (std::is_same_v<Value, double>) {
            if (!std::isfinite(value)) cursor_.fail_at_byte(std::string(what) + " is not a finite number");
            return value;
        } else {
            cursor_.fail_at_byte(std::string(what) + " is a real number; expected an integer");
        }
    }

    Scalar scalar() {
        const std::string_view name = cursor_.word("a type of number");
        const auto found = scalar_of(lower(name));
        if (!found) cursor_.fail("numbers of the type " + in_quotes(name) + " are not known");
        return *found;
    }

    /// A product of counts that the file could hold.
    std::size_t product(std::size_t a, std::size_t b) const {
        if (b != 0 && a > (cursor_.remaining() + 1) / b) {
            cursor_.fail(std::to_string(a) + " times " + std::to_string(b) + " values are more than the file can hold");
        }
        return a * b;
    }

    void read_points() {
        if (has_points_) cursor_.fail("the file holds POINTS twice");
        has_points_ = true;
        const std::size_t count = cursor_.count("the number of points", 3);
        const Scalar type = scalar();
        const auto coordinates = values<double>(type, product(count, 3), "a coordinate");
        raw_.definition.nodes.resize(count);
        for (std::size_t n = 0; n < count; ++n) {
            raw_.definition.nodes[n] = {coordinates[3 * n], coordinates[3 * n + 1], coordinates[3 * n + 2]};
        }
    }

    void read_cells() {
        if (has_cells_) cursor_.fail("the file holds CELLS twice");
        has_cells_ = true;
        const std::size_t count = cursor_.count("the number of cells", 1);
        cells_place_ = cursor_.position();
        const std::size_t size = cursor_.count("the size of the list of cells", 1);
        Cursor ahead = cursor_;
        if (lower(ahead.peek_word()) == "offsets") {
            read_offset_cells(count, size);
            return;
        }
        const auto list = values<std::int64_t>(Scalar::i32, size, "the cells");
        cells_.ends.reserve(count);
        cells_.connectivity.reserve(list.size());
        std::size_t at = 0;
        for (std::size_t c = 0; c < count; ++c) {
            const std::int64_t nodes = at < list.size() ? list[at] : -1;
            if (nodes < 0 || static_cast<std::uint64_t>(nodes) > list.size() - at - 1) {
                cursor_.fail("cell " + std::to_string(c) + " does not fit into the " + std::to_string(size) +
                             " numbers announced");
            }
            ++at;
            for (std::int64_t n = 0; n < nodes; ++n) cells_.connectivity.push_back(list[at++]);
            cells_.ends.push_back(static_cast<std::int64_t>(cells_.connectivity.size()));
        }
        if (at != list.size()) {
            cursor_.fail("the cells take " + std::to_string(at) + " of the " + std::to_string(size) +
                         " numbers announced");
        }
    }

    /// Since version 5: one more offset than cells, then the nodes.
    void read_offset_cells(std::size_t count, std::size_t size) {
        cursor_.word("OFFSETS");
        const auto offsets = values<std::int64_t>(scalar(), count, "an offset");
        if (!offsets.empty()) {
            if (offsets.front() != 0)
                cursor_.fail("the first offset is " + std::to_string(offsets.front()) + "; expected 0");
            cells_.ends.assign(offsets.begin() + 1, offsets.end());
        }
        if (lower(cursor_.word("CONNECTIVITY")) != "connectivity") cursor_.fail("expected CONNECTIVITY");
        cells_.connectivity = values<std::int64_t>(scalar(), size, "a node of a cell");
    }

    void read_types() {
        if (has_types_) cursor_.fail("the file holds CELL_TYPES twice");
        has_types_ = true;
        const std::size_t count = cursor_.count("the number of cell types", 2);
        cells_.types = values<std::int64_t>(Scalar::i32, count, "a cell type");
    }

    void read_data_header(bool cells) {
        in_cell_data_ = cells;
        tuples_ = cursor_.count("the number of values", 1);
        const std::size_t expected = cells ? cells_.ends.size() : raw_.definition.nodes.size();
        if (tuples_ != expected) {
            cursor_.fail("data for " + std::to_string(tuples_) + (cells ? " cells" : " points") + "; there are " +
                         std::to_string(expected));
        }
    }

    /// Keeps the first array that tells regions and passes over the others.
    void read_array(const std::string& name, Scalar type, std::size_t components, std::size_t tuples) {
        const std::size_t count = product(tuples, components);
        if (in_cell_data_ && components == 1 && regions_.empty() && tuples == cells_.ends.size() &&
            is_region_name(name)) {
            regions_ = values<double>(type, count, "a region");
        } else {
            pass_over(type, count);
        }
    }

    void pass_over(Scalar type, std::size_t count) {
        if (binary_) {
            cursor_.line();
            cursor_.bytes(product(count, size_of(type)), "an array");
            return;
        }
        for (std::size_t n = 0; n < count; ++n) cursor_.word("a value");
    }

    void read_attribute(const std::string& keyword) {
        const auto array = [&](std::size_t components) {
            const std::string name(cursor_.word("a name"));
            const Scalar type = scalar();
            read_array(name, type, components, tuples_);
        };
        if (keyword == "scalars") {
            read_scalars();
        } else if (keyword == "vectors" || keyword == "normals") {
            array(3);
        } else if (keyword == "tensors") {
            array(9);
        } else if (keyword == "tensors6") {
            array(6);
        } else if (keyword == "global_ids" || keyword == "pedigree_ids") {
            array(1);
        } else if (keyword == "field") {
            read_field();
        } else if (keyword == "lookup_table" || keyword == "color_scalars") {
            cursor_.word("a name");
            const bool table = keyword == "lookup_table";
            const std::size_t count = cursor_.count(table ? "the size of a table" : "the number of components", 1);
            pass_over(Scalar::u8, product(table ? 4 : tuples_, count));
        } else {
            cursor_.fail("the keyword " + in_quotes(keyword) + " is not known");
        }
    }

    void read_scalars() {
        const std::string name(cursor_.word("a name"));
        const Scalar type = scalar();
        std::size_t components = 1;
        // The number of components may be left out; a table of colors may be named on the next line.
        const std::string_view rest = trimmed(cursor_.rest().substr(0, cursor_.rest().find('\n')));
        if (!rest.empty()) components = cursor_.count("the number of components", 1);
        Cursor ahead = cursor_;
        if (lower(ahead.peek_word()) == "lookup_table") {
            cursor_.word("LOOKUP_TABLE");
            cursor_.word("a name");
        }
        read_array(name, type, components, tuples_);
    }

    void read_field() {
        cursor_.word("a name");
        const std::size_t arrays = cursor_.count("the number of arrays", 8);
        for (std::size_t a = 0; a < arrays; ++a) {
            std::string name(cursor_.word("a name"));
            if (lower(name) == "metadata") {
                cursor_.line();
                while (cursor_.remaining() > 0 && !trimmed(cursor_.line()).empty()) {
                }
                name = cursor_.word("a name");
            }
            const std::size_t components = cursor_.count("the number of components", 1);
            const std::size_t tuples = cursor_.count("the number of values", 1);
            const std::string_view type_name = cursor_.word("a type of number");
            const auto type = scalar_of(lower(type_name));
            if (!type) {
                raw_.notes.push_back("data from array " + in_quotes(name) + " of the type " + in_quotes(type_name) +
                                     " onward is not read");
                stopped_ = true;
                return;
            }
            read_array(name, *type, components, tuples);
        }
    }

    Cursor& cursor_;
    RawMesh raw_;
    VtkCells cells_;
    std::vector<double> regions_;
    std::size_t cells_place_ = 0;
    std::size_t tuples_ = 0;
    bool binary_ = false;
    bool in_cell_data_ = false;
    bool has_points_ = false;
    bool has_cells_ = false;
    bool has_types_ = false;
    bool stopped_ = false;
};

}  // namespace

RawMesh read_vtk_legacy(Cursor& cursor) {
    return Reader(cursor).read();
}

}  // namespace lancet::mesh::io
