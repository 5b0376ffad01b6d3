// VTK's XML format, unstructured grids (.vtu).
#include <bit>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <pugixml.hpp>

#include "lancet/mesh/io/raw_mesh.hpp"
#include "lancet/mesh/io/vtk_cells.hpp"
#include "lancet/mesh/io/vtk_data.hpp"

namespace lancet::mesh::io {

namespace {

class Reader {
  public:
    Reader(std::string_view content, const std::string& name) : content_(content), name_(name) {}

    RawMesh read() {
        parse_xml();
        const pugi::xml_node file = document_.child("VTKFile");
        if (!file) fail(document_, "expected <VTKFile>");
        read_coding(file);
        const pugi::xml_node grid = file.child("UnstructuredGrid");
        if (!grid) fail(file, "expected <UnstructuredGrid>");
        for (const pugi::xml_node piece : grid.children("Piece")) read_piece(piece);
        others_.report(name_, raw_.notes);
        raw_.definition.regions.resize(has_regions_ ? raw_.definition.tetrahedra.size() : 0, 0);
        return std::move(raw_);
    }

  private:
    /// Appended data may be binary: the parser gets the text before them, and closing tags.
    void parse_xml() {
        xml_ = content_;
        const std::size_t appended = content_.find("<AppendedData");
        if (appended != std::string_view::npos) {
            const std::size_t close = content_.find('>', appended);
            const std::size_t start =
                close == std::string_view::npos ? close : content_.find_first_not_of(" \t\r\n", close + 1);
            if (start == std::string_view::npos || content_[start] != '_') {
                Cursor place(content_, name_, appended);
                place.fail("expected '_' and data behind <AppendedData>");
            }
            const std::size_t end = content_.rfind("</AppendedData>");
            appended_begin_ = start + 1;
            appended_end_ = end == std::string_view::npos || end < start ? content_.size() : end;
            xml_.resize(close + 1);
            xml_ += "</AppendedData></VTKFile>";
        }
        // Nothing is rewritten but names and attributes, so that places in the text stay places in the file.
        const pugi::xml_parse_result result = document_.load_buffer_inplace(
            xml_.data(), xml_.size(), pugi::parse_minimal | pugi::parse_wconv_attribute | pugi::parse_escapes,
            pugi::encoding_utf8);
        if (!result) {
            Cursor place(content_, name_, static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, result.offset)));
            place.fail(std::string("not well-formed XML: ") + result.description());
        }
    }

    Cursor place_of(const pugi::xml_node& node) const {
        const std::ptrdiff_t offset = node.offset_debug();
        return {content_, name_, offset < 0 ? 0 : static_cast<std::size_t>(offset)};
    }

    [[noreturn]] void fail(const pugi::xml_node& node, const std::string& message) const {
        place_of(node).fail(message);
    }

    void read_coding(const pugi::xml_node& file) {
        const std::string type = file.attribute("type").value();
        if (type != "UnstructuredGrid")
            fail(file, "a file of the type " + in_quotes(type) + "; expected UnstructuredGrid");
        const std::string order = file.attribute("byte_order").as_string("LittleEndian");
        if (order != "LittleEndian" && order != "BigEndian") {
            fail(file, "byte_order " + in_quotes(order) + "; expected LittleEndian or BigEndian");
        }
        coding_.swap = (order == "BigEndian") != (std::endian::native == std::endian::big);
        const std::string header = file.attribute("header_type").as_string("UInt32");
        if (header != "UInt32" && header != "UInt64") {
            fail(file, "header_type " + in_quotes(header) + "; expected UInt32 or UInt64");
        }
        coding_.wide_header = header == "UInt64";
        const std::string compressor = file.attribute("compressor").value();
        if (!compressor.empty() && compressor != "vtkZLibDataCompressor") {
            fail(file, "compressor " + in_quotes(compressor) + "; expected vtkZLibDataCompressor or none");
        }
        coding_.compressed = !compressor.empty();
        const pugi::xml_node appended = file.child("AppendedData");
        const std::string encoding = appended.attribute("encoding").as_string("raw");
        if (encoding != "raw" && encoding != "base64") {
            fail(appended, "encoding " + in_quotes(encoding) + "; expected raw or base64");
        }
        appended_base64_ = encoding == "base64";
    }

    std::size_t count(const pugi::xml_node& node, const char* attribute) const {
        std::int64_t value = 0;
        const std::string text = node.attribute(attribute).value();
        if (!parse(text, value) || value < 0 || value > std::numeric_limits<std::int32_t>::max()) {
            fail(node, std::string(attribute) + " is " + in_quotes(text) + "; expected an integer from 0 to " +
                           std::to_string(std::numeric_limits<std::int32_t>::max()));
        }
        return static_cast<std::size_t>(value);
    }

    VtkArray locate(const pugi::xml_node& node) const {
        VtkArray array;
        array.type = node.attribute("type").value();
        array.name = node.attribute("Name").value();
        const std::string format = node.attribute("format").as_string("ascii");
        if (format == "appended") {
            if (appended_begin_ == 0) fail(node, "an appended array, but there is no <AppendedData>");
            std::int64_t offset = 0;
            const std::string text = node.attribute("offset").value();
            if (!parse(text, offset) || offset < 0 ||
                static_cast<std::uint64_t>(offset) > appended_end_ - appended_begin_) {
                fail(node, "offset " + in_quotes(text) + " is not in the appended data of " +
                               std::to_string(appended_end_ - appended_begin_) + " bytes");
            }
            array.layout = appended_base64_ ? VtkArray::Layout::base64 : VtkArray::Layout::raw;
            array.begin = appended_begin_ + static_cast<std::size_t>(offset);
            array.end = appended_end_;
            return array;
        }
        if (format != "ascii" && format != "binary") {
            fail(node, "format " + in_quotes(format) + "; expected ascii, binary or appended");
        }
        array.layout = format == "ascii" ? VtkArray::Layout::ascii : VtkArray::Layout::base64;
        for (const pugi::xml_node child : node.children()) {
            if (child.type() != pugi::node_pcdata) continue;
            const std::string_view text = child.value();
            array.begin = static_cast<std::size_t>(text.data() - xml_.data());
            array.end = array.begin + text.size();
            break;
        }
        return array;
    }

    static std::size_t components(const pugi::xml_node& array) {
        return array.attribute("NumberOfComponents").as_uint(1);
    }

    pugi::xml_node array_named(const pugi::xml_node& parent, const char* name) const {
        const pugi::xml_node found = parent.find_child_by_attribute("DataArray", "Name", name);
        if (!found) fail(parent, std::string("expected an array named ") + name);
        return found;
    }

    std::vector<std::int64_t> integers(const pugi::xml_node& node, std::size_t size) const {
        return read_vtk_integers(locate(node), coding_, size, place_of(node));
    }

    void read_piece(const pugi::xml_node& piece) {
        const std::size_t points = count(piece, "NumberOfPoints");
        const std::size_t cell_count = count(piece, "NumberOfCells");
        const std::size_t first = raw_.definition.nodes.size();
        if (first + points > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
            fail(piece, "more points than 32-bit numbers count");
        }
        if (points == 0 && cell_count == 0) return;
        read_points(piece, points);

        const pugi::xml_node cells_node = piece.child("Cells");
        if (!cells_node) fail(piece, "expected <Cells>");
        VtkCells cells;
        const pugi::xml_node ends = array_named(cells_node, "offsets");
        cells.ends = integers(ends, cell_count);
        cells.types = integers(array_named(cells_node, "types"), cell_count);
        const std::int64_t size = cells.ends.empty() ? 0 : cells.ends.back();
        // A cell of very many nodes takes its place in the file, too.
        if (size < 0 || static_cast<std::uint64_t>(size) / 1100 > content_.size()) {
            fail(ends, "the last offset is " + std::to_string(size));
        }
        const pugi::xml_node connectivity = array_named(cells_node, "connectivity");
        cells.connectivity = integers(connectivity, static_cast<std::size_t>(size));
        const auto taken = append_vtk_cells(cells, first, points, place_of(connectivity), raw_, others_);
        read_regions(piece, cell_count, taken);
        read_sets(piece, points, first);
    }

    void read_points(const pugi::xml_node& piece, std::size_t points) {
        const pugi::xml_node node = piece.child("Points").child("DataArray");
        if (!node) fail(piece, "expected <Points> with a <DataArray>");
        if (components(node) != 3) {
            fail(node, "points of " + std::to_string(components(node)) + " components; expected 3");
        }
        const auto values = read_vtk_reals(locate(node), coding_, 3 * points, place_of(node));
        for (std::size_t n = 0; n < points; ++n) {
            raw_.definition.nodes.push_back({values[3 * n], values[3 * n + 1], values[3 * n + 2]});
        }
    }

    void read_regions(const pugi::xml_node& piece, std::size_t cells, const std::vector<std::size_t>& taken) {
        for (const pugi::xml_node node : piece.child("CellData").children("DataArray")) {
            if (!is_region_name(node.attribute("Name").value()) || components(node) != 1) continue;
            // Earlier pieces may have had no regions.
            raw_.definition.regions.resize(raw_.definition.tetrahedra.size() - taken.size(), 0);
            const auto values = read_vtk_reals(locate(node), coding_, cells, place_of(node));
            if (set_regions(values, taken, raw_)) {
                has_regions_ = true;
            } else {
                raw_.notes.push_back("the values of the cell array " + in_quotes(node.attribute("Name").value()) +
                                     " are not integers of 32 bits: not taken for regions");
            }
            return;
        }
    }

    /// Node sets, the way write_vtu() stores them: 1 for members, 0 for others.
    void read_sets(const pugi::xml_node& piece, std::size_t points, std::size_t first) {
        constexpr std::string_view prefix = "set:";
        for (const pugi::xml_node node : piece.child("PointData").children("DataArray")) {
            const std::string_view name = node.attribute("Name").value();
            if (!name.starts_with(prefix) || components(node) != 1) continue;
            const auto members = integers(node, points);
            auto& set = raw_.definition.node_sets[std::string(name.substr(prefix.size()))];
            for (std::size_t n = 0; n < points; ++n) {
                if (members[n] != 0) set.push_back(static_cast<std::int32_t>(first + n));
            }
        }
    }

    std::string_view content_;
    const std::string& name_;
    std::string xml_;
    pugi::xml_document document_;
    VtkCoding coding_;
    RawMesh raw_;
    OtherCells others_;
    std::size_t appended_begin_ = 0;
    std::size_t appended_end_ = 0;
    bool appended_base64_ = false;
    bool has_regions_ = false;
};

}  // namespace

RawMesh read_vtk_xml(std::string_view content, const std::string& name) {
    return Reader(content, name).read();
}

}  // namespace lancet::mesh::io
