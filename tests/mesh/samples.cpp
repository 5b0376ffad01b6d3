#include "tests/mesh/samples.hpp"

#include <bit>
#include <cstdint>
#include <cstring>
#include <functional>

#include <zlib.h>

#include "lancet/mesh/io/cursor.hpp"

namespace lancet::mesh::test {

namespace {

constexpr double coordinates[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1.25};
constexpr int tetrahedra[8] = {0, 1, 2, 3, 1, 2, 3, 4};

/// Binary numbers in the byte order asked for, between pieces of text.
class Bytes {
  public:
    explicit Bytes(bool big) : swap_(big != (std::endian::native == std::endian::big)) {}

    Bytes& text(const std::string& piece) {
        content_ += piece;
        return *this;
    }
    template <typename Value>
    Bytes& put(Value value) {
        if (swap_) value = io::byte_swapped(value);
        content_.append(reinterpret_cast<const char*>(&value), sizeof(Value));
        return *this;
    }
    template <typename Value, typename Values>
    Bytes& put_all(const Values& values) {
        for (const auto value : values) put(static_cast<Value>(value));
        return *this;
    }
    const std::string& content() const { return content_; }

  private:
    bool swap_;
    std::string content_;
};

const char* const names = "$PhysicalNames\n3\n2 5 \"skin\"\n3 3 \"liver\"\n3 7 \"vessel\"\n$EndPhysicalNames\n";

std::string gmsh_1() {
    return "$NOD\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n9 1 1 1.25\n$ENDNOD\n$ELM\n3\n1 2 5 5 3 1 2 3\n"
           "2 4 3 1 4 1 2 3 4\n3 4 7 1 4 2 3 4 9\n$ENDELM\n";
}

std::string gmsh_2_text() {
    return std::string("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n") + names +
           "$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n900000 1 1 1.25\n$EndNodes\n$Elements\n3\n"
           "1 2 2 5 5 1 2 3\n2 4 2 3 1 1 2 3 4\n3 4 2 7 1 2 3 4 900000\n$EndElements\n"
           "$NodeData\n1\n\"A view\"\n1\n0\n3\n0\n1\n1\n1 0.5\n$EndNodeData\n";
}

std::string gmsh_2_binary(bool big) {
    Bytes b(big);
    b.text("$MeshFormat\n2.2 1 8\n").put(std::int32_t{1}).text("\n$EndMeshFormat\n").text(names);
    b.text("$Nodes\n5\n");
    for (std::int32_t n = 0; n < 5; ++n) {
        b.put(n + 1).put(coordinates[3 * n]).put(coordinates[3 * n + 1]).put(coordinates[3 * n + 2]);
    }
    b.text("\n$EndNodes\n$Elements\n3\n");
    b.put_all<std::int32_t>(std::vector<int>{2, 1, 2, 1, 5, 5, 1, 2, 3});
    b.put_all<std::int32_t>(std::vector<int>{4, 2, 2, 2, 3, 1, 1, 2, 3, 4, 3, 7, 1, 2, 3, 4, 5});
    return b.text("\n$EndElements\n").content();
}

std::string gmsh_4_text() {
    return std::string("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n") + names +
           "$Entities\n1 0 1 2\n1 0 0 0 0\n1 0 0 0 1 1 0 1 -5 1 2\n1 0 0 0 1 1 1 1 3 1 1\n"
           "2 0 0 0 1 1 1 1 7 0\n$EndEntities\n$Nodes\n2 5 1 5\n2 1 1 2\n1\n2\n0 0 0 0.1 0.2\n1 0 0 0.3 0.4\n"
           "3 1 0 3\n3\n4\n5\n0 1 0\n0 0 1\n1 1 1.25\n$EndNodes\n$Elements\n3 3 1 3\n2 1 2 1\n1 1 2 3\n"
           "3 1 4 1\n2 1 2 3 4\n3 2 4 1\n3 2 3 4 5\n$EndElements\n";
}

std::string gmsh_4_binary(bool big) {
    using Size = std::uint64_t;
    using Int = std::int32_t;
    Bytes b(big);
    b.text("$MeshFormat\n4.1 1 8\n").put(Int{1}).text("\n$EndMeshFormat\n").text(names).text("$Entities\n");
    const std::vector<double> bounds{0, 0, 0, 1, 1, 1};
    b.put_all<Size>(std::vector<int>{0, 0, 1, 2});
    b.put(Int{1}).put_all<double>(bounds).put(Size{1}).put(Int{5}).put(Size{0});
    b.put(Int{1}).put_all<double>(bounds).put(Size{1}).put(Int{3}).put(Size{1}).put(Int{1});
    b.put(Int{2}).put_all<double>(bounds).put(Size{1}).put(Int{7}).put(Size{0});
    b.text("\n$EndEntities\n$Nodes\n").put_all<Size>(std::vector<int>{1, 5, 1, 5});
    b.put_all<Int>(std::vector<int>{3, 1, 0}).put(Size{5}).put_all<Size>(std::vector<int>{1, 2, 3, 4, 5});
    b.put_all<double>(coordinates).text("\n$EndNodes\n$Elements\n").put_all<Size>(std::vector<int>{3, 3, 1, 3});
    b.put_all<Int>(std::vector<int>{2, 1, 2}).put(Size{1}).put_all<Size>(std::vector<int>{1, 1, 2, 3});
    b.put_all<Int>(std::vector<int>{3, 1, 4}).put(Size{1}).put_all<Size>(std::vector<int>{2, 1, 2, 3, 4});
    b.put_all<Int>(std::vector<int>{3, 2, 4}).put(Size{1}).put_all<Size>(std::vector<int>{3, 2, 3, 4, 5});
    return b.text("\n$EndElements\n").content();
}

std::string vtk_text() {
    return "# vtk DataFile Version 3.0\ntwo tetrahedra\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n"
           "0 0 0 1 0 0\n0 1 0 0 0 1\n1 1 1.25\nCELLS 3 14\n4 0 1 2 3\n3 0 1 2\n4 1 2 3 4\nCELL_TYPES 3\n10 5 10\n"
           "POINT_DATA 5\nVECTORS u double\n0 0 0 1 2 3 nan 5 6 7 8 9 1 2 3\nSCALARS t float 1\n"
           "LOOKUP_TABLE default\n1 2 3 4 5\nCELL_DATA 3\nFIELD FieldData 1\nregion 1 3 int\n3 0 7\n";
}

std::string vtk_text_5() {
    return "# vtk DataFile Version 5.1\ntwo tetrahedra\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n"
           "0 0 0 1 0 0\n0 1 0 0 0 1\n1 1 1.25\nMETADATA\nINFORMATION 0\n\nCELLS 3 8\nOFFSETS vtktypeint64\n0 4 8\n"
           "CONNECTIVITY vtktypeint64\n0 1 2 3 1 2 3 4\nCELL_TYPES 2\n10\n10\nCELL_DATA 2\nSCALARS material int\n"
           "LOOKUP_TABLE default\n3\n7\n";
}

std::string vtk_binary() {
    Bytes b(true);
    b.text("# vtk DataFile Version 2.0\ntwo tetrahedra\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n");
    b.put_all<float>(coordinates).text("\nCELLS 2 10\n");
    b.put_all<std::int32_t>(std::vector<int>{4, 0, 1, 2, 3, 4, 1, 2, 3, 4}).text("\nCELL_TYPES 2\n");
    b.put_all<std::int32_t>(std::vector<int>{10, 10}).text("\nPOINT_DATA 5\nNORMALS n float\n");
    b.put_all<float>(coordinates).text("\nCELL_DATA 2\nSCALARS region short\nLOOKUP_TABLE default\n");
    return b.put_all<std::int16_t>(std::vector<int>{3, 7}).text("\n").content();
}

std::string vtk_binary_5() {
    Bytes b(true);
    b.text("# vtk DataFile Version 5.1\ntwo tetrahedra\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n");
    b.put_all<double>(coordinates).text("\nMETADATA\nINFORMATION 0\n\nCELLS 3 8\nOFFSETS vtktypeint64\n");
    b.put_all<std::int64_t>(std::vector<int>{0, 4, 8}).text("\nCONNECTIVITY vtktypeint64\n");
    b.put_all<std::int64_t>(tetrahedra).text("\nCELL_TYPES 2\n");
    b.put_all<std::int32_t>(std::vector<int>{10, 10}).text("\nCELL_DATA 2\nFIELD FieldData 1\nMaterialIds 1 2 int\n");
    return b.put_all<std::int32_t>(std::vector<int>{3, 7}).text("\nMETADATA\nINFORMATION 0\n\n").content();
}

std::string base64(const std::string& bytes) {
    constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t n = 0; n < bytes.size(); n += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            bits = (bits << 8) | (n + k < bytes.size() ? static_cast<unsigned char>(bytes[n + k]) : 0U);
        }
        for (std::size_t k = 0; k < 4; ++k) text += n + k <= bytes.size() ? digits[(bits >> (18 - 6 * k)) & 63U] : '=';
    }
    return text;
}

struct XmlVariant {
    std::string layout;  // ascii, binary, raw, base64
    bool big = false;
    bool wide = false;
    bool compressed = false;
};

/// Header and data of one array as the format wants them; compressed in blocks of 32 bytes.
std::string packed(const std::string& data, const XmlVariant& variant) {
    Bytes header(variant.big);
    const auto number = [&](std::size_t value) {
        if (variant.wide) header.put(static_cast<std::uint64_t>(value));
        if (!variant.wide) header.put(static_cast<std::uint32_t>(value));
    };
    const bool coded = variant.layout == "binary" || variant.layout == "base64";
    if (!variant.compressed) {
        number(data.size());
        return coded ? base64(header.content() + data) : header.content() + data;
    }
    constexpr std::size_t block = 32;
    number((data.size() + block - 1) / block);
    number(block);
    number(data.size() % block);
    std::string body;
    for (std::size_t at = 0; at < data.size(); at += block) {
        const std::string piece = data.substr(at, block);
        std::string out(compressBound(static_cast<uLong>(piece.size())), '\0');
        auto size = static_cast<uLongf>(out.size());
        compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(piece.data()),
                 static_cast<uLong>(piece.size()));
        number(size);
        body += out.substr(0, size);
    }
    return coded ? base64(header.content()) + base64(body) : header.content() + body;
}

std::string vtu(const XmlVariant& variant) {
    std::string appended;
    const auto array = [&](const std::string& attributes, const std::string& text, const std::string& data) {
        std::string element = "<DataArray " + attributes;
        if (variant.layout == "ascii") return element + " format=\"ascii\">\n" + text + "\n</DataArray>\n";
        const std::string bytes = packed(data, variant);
        if (variant.layout == "binary") return element + " format=\"binary\">\n" + bytes + "\n</DataArray>\n";
        element += " format=\"appended\" offset=\"" + std::to_string(appended.size()) + "\"/>\n";
        appended += bytes;
        return element;
    };
    const auto bytes = [&](const std::function<void(Bytes&)>& fill) {
        Bytes b(variant.big);
        fill(b);
        return b.content();
    };
    std::string file =
        "<?xml version=\"1.0\"?>\n<!-- two tetrahedra -->\n<VTKFile type=\"UnstructuredGrid\" "
        "version=\"0.1\"";
    file += variant.big ? " byte_order=\"BigEndian\"" : " byte_order=\"LittleEndian\"";
    if (variant.wide) file += " header_type=\"UInt64\"";
    if (variant.compressed) file += " compressor=\"vtkZLibDataCompressor\"";
    file += ">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"5\" NumberOfCells=\"3\">\n<PointData>\n";
    file += array("type=\"UInt8\" Name=\"set:held &amp; fixed\"", "1 0 0 0 1", bytes([](Bytes& b) {
                      b.put_all<std::uint8_t>(std::vector<int>{1, 0, 0, 0, 1});
                  }));
    file += "</PointData>\n<CellData>\n";
    file += array("type=\"Int16\" Name=\"region\"", "3 0 7", bytes([](Bytes& b) {
                      b.put_all<std::int16_t>(std::vector<int>{3, 0, 7});
                  }));
    file += "</CellData>\n<Points>\n";
    file += array("type=\"Float32\" NumberOfComponents=\"3\"", "0 0 0  1 0 0  0 1 0  0 0 1  1 1 1.25",
                  bytes([](Bytes& b) { b.put_all<float>(coordinates); }));
    file += "</Points>\n<Cells>\n";
    const std::vector<int> connectivity{0, 1, 2, 3, 0, 1, 2, 1, 2, 3, 4};
    file += array("type=\"Int32\" Name=\"connectivity\"", "0 1 2 3  0 1 2  1 2 3 4",
                  bytes([&](Bytes& b) { b.put_all<std::int32_t>(connectivity); }));
    file += array("type=\"Int64\" Name=\"offsets\"", "4 7 11", bytes([](Bytes& b) {
                      b.put_all<std::int64_t>(std::vector<int>{4, 7, 11});
                  }));
    file += array("type=\"UInt8\" Name=\"types\"", "10 5 10", bytes([](Bytes& b) {
                      b.put_all<std::uint8_t>(std::vector<int>{10, 5, 10});
                  }));
    file += "</Cells>\n</Piece>\n</UnstructuredGrid>\n";
    if (!appended.empty()) {
        file += "<AppendedData encoding=\"" + variant.layout + "\">\n_" + appended + "\n</AppendedData>\n";
    }
    return file + "</VTKFile>\n";
}

std::string tetgen_nodes() {
    return "# two tetrahedra\n5 3 1 1\n\n1  0 0 0  0.5 1\n2  1 0 0  0.5 0 # beside\n3  0 1 0  0.5 0\n4  0 0 1  0.5 0\n"
           "5  1 1 1.25  0.5 2\n";
}

std::string tetgen_elements() {
    return "2 4 1\n1  1 2 3 4  3\n2  2 3 4 5  7\n# the end\n";
}

std::string abaqus() {
    return "*Heading\n two tetrahedra\n** a comment\n*NODE, NSET=ALL\n10, 0., 0., 0.\n20, 1., 0., 0.\n30, 0., 1., 0.\n"
           "40, 0., 0., 1.\n50, 1., 1., 1.25\n*ELEMENT, TYPE=S3, ELSET=SKIN\n1, 10, 20, 30\n"
           "*Element, type=C3D4,\n elset=first\n2, 10, 20, 30, 40\n3, 20, 30, 40, 50\n*NSET, NSET=base, GENERATE\n"
           "10, 30, 10\n*Nset, nset=held\n50, base,\n*ELSET, ELSET=second\n3\n*ELSET, ELSET=many, GENERATE\n"
           "1, 3\n*SOLID SECTION, ELSET=SKIN, MATERIAL=a\n*Solid Section, elset=none, material=a\n"
           "*Solid Section, elset=first, material=a\n*Solid Section, elset=s4\n*Solid Section, elset=s5\n"
           "*Solid Section, elset=s6\n*Solid Section, elset=second, material=b\n1.,\n*STEP\n*END STEP\n";
}

}  // namespace

std::vector<Sample> samples() {
    std::vector<Sample> all{{"gmsh 1", MeshFormat::gmsh, gmsh_1(), {}},
                            {"gmsh 2.2 text", MeshFormat::gmsh, gmsh_2_text(), {}},
                            {"gmsh 2.2 binary little", MeshFormat::gmsh, gmsh_2_binary(false), {}},
                            {"gmsh 2.2 binary big", MeshFormat::gmsh, gmsh_2_binary(true), {}},
                            {"gmsh 4.1 text", MeshFormat::gmsh, gmsh_4_text(), {}},
                            {"gmsh 4.1 binary little", MeshFormat::gmsh, gmsh_4_binary(false), {}},
                            {"gmsh 4.1 binary big", MeshFormat::gmsh, gmsh_4_binary(true), {}},
                            {"vtk text", MeshFormat::vtk_legacy, vtk_text(), {}},
                            {"vtk 5 text", MeshFormat::vtk_legacy, vtk_text_5(), {}},
                            {"vtk binary", MeshFormat::vtk_legacy, vtk_binary(), {}},
                            {"vtk 5 binary", MeshFormat::vtk_legacy, vtk_binary_5(), {}},
                            {"tetgen", MeshFormat::tetgen, tetgen_nodes(), tetgen_elements()},
                            {"abaqus", MeshFormat::abaqus, abaqus(), {}}};
    for (const char* layout : {"ascii", "binary", "raw", "base64"}) {
        for (const bool big : {false, true}) {
            for (const bool wide : {false, true}) {
                for (const bool compressed : {false, true}) {
                    const std::string name = std::string("vtu ") + layout + (big ? " big" : " little") +
                                             (wide ? " UInt64" : " UInt32") + (compressed ? " zlib" : "");
                    all.push_back({name, MeshFormat::vtk_xml, vtu({layout, big, wide, compressed}), {}});
                }
            }
        }
    }
    return all;
}

}  // namespace lancet::mesh::test
