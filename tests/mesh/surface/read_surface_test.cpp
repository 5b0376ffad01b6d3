// Files in every format, as they should be and as they should not; thousands of damaged ones.
#include "lancet/mesh/io/read_surface.hpp"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <random>

#include "tests/experiments/common/temporary_folder.hpp"
#include "tests/mesh/surface/shapes.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::mesh::test {
namespace {

using testing::HasSubstr;

struct File {
    const char* name;
    SurfaceFormat format;
    std::string content;
};

template <class Value>
void append(std::string& bytes, Value value, bool reversed = false) {
    char raw[sizeof(Value)];
    std::memcpy(raw, &value, sizeof(Value));
    if (reversed) std::reverse(raw, raw + sizeof(Value));
    bytes.append(raw, sizeof(Value));
}

constexpr Point corners[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1.25}};

std::string binary_ply(bool big) {
    std::string file = std::string("ply\r\nformat binary_") + (big ? "big" : "little") +
                       "_endian 1.0\r\ncomment a pyramid\r\nelement colour 1\r\nproperty uchar red\r\n"
                       "element vertex 5\r\nproperty float32 quality\r\nproperty double x\r\nproperty double y\r\n"
                       "property double z\r\nelement face 5\r\nproperty list uint8 uint32 vertex_index\r\n"
                       "property list ushort short texture\r\nend_header\r\n";
    append(file, std::uint8_t{200});
    for (const Point& p : corners) {
        append(file, 1.0F, big);
        for (const double value : p) append(file, value, big);
    }
    const std::vector<std::vector<std::uint32_t>> faces{{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    for (const auto& face : faces) {
        append(file, static_cast<std::uint8_t>(face.size()));
        for (const std::uint32_t vertex : face) append(file, vertex, big);
        append(file, std::uint16_t{2}, big);
        append(file, std::int16_t{-1}, big);
        append(file, std::int16_t{7}, big);
    }
    return file;
}

/// The pyramid's triangles, for STL.
std::vector<std::array<Point, 3>> facets() {
    std::vector<std::array<Point, 3>> result;
    for (const auto& [a, b, c] : {Triangle{0, 3, 2}, {0, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}) {
        result.push_back({corners[a], corners[b], corners[c]});
    }
    return result;
}

std::string binary_stl() {
    std::string file = "solid in spite of its name";
    file.resize(80, ' ');
    append(file, std::uint32_t{6});
    for (const auto& facet : facets()) {
        for (int axis = 0; axis < 3; ++axis) append(file, 0.0F);
        for (const Point& p : facet) {
            for (const double value : p) append(file, static_cast<float>(value));
        }
        append(file, std::uint16_t{0});
    }
    return file;
}

std::string text_stl() {
    std::string file = "solid a pyramid\n";
    for (const auto& facet : facets()) {
        file += "  FACET NORMAL nan 0 0\n    outer loop\n";
        for (const Point& p : facet) {
            file += "      vertex";
            for (const double value : p) file += ' ' + std::to_string(value);
            file += '\n';
        }
        file += "    endloop\n  endfacet\n";
    }
    return file + "endsolid a pyramid\n";
}

/// The same pyramid of five corners and six triangles in every variant.
std::vector<File> files() {
    const std::string obj =
        "# a pyramid\nmtllib none.mtl\no pyramid\nv 0 0 0\nv 1 0 0 1\nv 1e0 +1 0\nv 0 1 \\\n 0\nvt 0 0\nvn 0 0 1\n"
        "f 1 4 3 2 # the ground\nv .5 .5 1.25\nusemtl red\ns off\nf 1/1 2/1 5/1\nf 2//1 3//1 5//1\nf 3/1/1 4/1/1 "
        "5/1/1\n"
        "f -2 -5 -1\n";
    const std::string ply =
        "ply\nformat ascii 1.0\ncomment a pyramid\nelement vertex 5\nproperty float x\nproperty float y\n"
        "property float z\nproperty uchar red\nelement face 5\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0 255\n0.5 0.5 1.25 0\n4 0 3 2 1\n3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n";
    return {{"obj", SurfaceFormat::obj, obj},
            {"text stl", SurfaceFormat::stl, text_stl()},
            {"binary stl", SurfaceFormat::stl, binary_stl()},
            {"text ply", SurfaceFormat::ply, ply},
            {"little-endian ply", SurfaceFormat::ply, binary_ply(false)},
            {"big-endian ply", SurfaceFormat::ply, binary_ply(true)}};
}

std::string message(SurfaceFormat format, const std::string& content, const ReadSurfaceOptions& options = {}) {
    try {
        read_surface_from_memory(format, content, "file", options);
    } catch (const Error& error) {
        return error.what();
    }
    return "nothing was thrown";
}

TEST(ReadSurface, EveryFormatHoldsTheSamePyramid) {
    for (const File& file : files()) {
        SCOPED_TRACE(file.name);
        const TriangleMesh surface = read_surface_from_memory(file.format, file.content);
        ASSERT_EQ(surface.vertices.size(), 5U);
        ASSERT_EQ(surface.triangles.size(), 6U);
        for (const Point& corner : corners) EXPECT_EQ(std::ranges::count(surface.vertices, corner), 1);
        const SurfaceTopology topology = surface_topology(surface.vertices.size(), surface.triangles);
        EXPECT_TRUE(topology.is_closed());
        EXPECT_TRUE(topology.is_boundary());
        EXPECT_NEAR(signed_volume(surface.vertices, surface.triangles), 1.25 / 3, 1e-15);
    }
}

TEST(ReadSurface, ReadsFilesByTheirExtension) {
    const experiments::test::TemporaryFolder folder;
    const std::vector<std::string> names{"a.obj", "b.STL", "c.stl", "d.ply", "e.PLY", "f.ply"};
    const std::vector<File> samples = files();
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const auto path = folder.path() / names[k];
        std::ofstream(path, std::ios::binary) << samples[k].content;
        const TriangleMesh surface = read_surface(path, {.scale = 0.1});
        EXPECT_NEAR(signed_volume(surface.vertices, surface.triangles), 1.25e-3 / 3, 1e-18);
    }
}

TEST(ReadSurface, PathsThatAreNoSurfacesAreNamed) {
    const experiments::test::TemporaryFolder folder;
    const auto thrown = [](const std::filesystem::path& path) -> std::string {
        try {
            read_surface(path);
        } catch (const Error& error) {
            return error.what();
        }
        return "nothing was thrown";
    };
    EXPECT_THAT(thrown(folder.path()), HasSubstr("is a folder; expected a surface file"));
    EXPECT_THAT(thrown(folder.path() / "none.obj"), HasSubstr("none.obj: cannot be opened"));
    std::ofstream(folder.path() / "a.xyz") << "v 0 0 0\n";
    EXPECT_THAT(thrown(folder.path() / "a.xyz"), HasSubstr("a.xyz: not a known surface file; expected .obj"));
    std::ofstream(folder.path() / "empty.ply").close();
    EXPECT_THAT(thrown(folder.path() / "empty.ply"), HasSubstr("empty.ply: the file is empty"));
}

TEST(ReadSurface, ErrorsSayWhereAndWhatWasExpected) {
    EXPECT_THAT(message(SurfaceFormat::obj, "v 0 0 0\nv 1 0 0\n"), HasSubstr("file: has no faces"));
    EXPECT_THAT(message(SurfaceFormat::obj, "v 0 0 0\nv nan 0 0\n"), HasSubstr("file: line 2: expected a coordinate"));
    EXPECT_THAT(message(SurfaceFormat::obj, "v 0 0 0\nv 1 0 1e999\n"), HasSubstr("line 2"));
    EXPECT_THAT(message(SurfaceFormat::obj, "v 0 0\n"), HasSubstr("found ''"));
    const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    EXPECT_THAT(message(SurfaceFormat::obj, three + "f 1 2 4\n"),
                HasSubstr("line 4: a face has vertex 4; there are 3"));
    EXPECT_THAT(message(SurfaceFormat::obj, three + "f 1 2 -4\n"), HasSubstr("vertex -4"));
    EXPECT_THAT(message(SurfaceFormat::obj, three + "f 0 1 2\n"), HasSubstr("vertex 0"));
    EXPECT_THAT(message(SurfaceFormat::obj, three + "f 1 2\n"), HasSubstr("expected at least 3"));
    EXPECT_THAT(message(SurfaceFormat::obj, std::string("\0\0\1", 3)), HasSubstr("not a Wavefront file"));
    EXPECT_THAT(message(SurfaceFormat::obj, three + "f 1 2 3\n", {.scale = 0}), HasSubstr("scale"));

    EXPECT_THAT(message(SurfaceFormat::stl, "solid\nendsolid\n"), HasSubstr("has no faces"));
    EXPECT_THAT(message(SurfaceFormat::stl, "hello\n"), HasSubstr("line 1: expected solid"));
    EXPECT_THAT(message(SurfaceFormat::stl, "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 inf 0\n"),
                HasSubstr("line 4: expected a coordinate"));
    EXPECT_THAT(message(SurfaceFormat::stl, "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"),
                HasSubstr("the file ends where vertex is expected"));
    std::string stl = binary_stl();
    stl[0] = 'x';
    EXPECT_THAT(message(SurfaceFormat::stl, stl.substr(0, stl.size() - 1)), HasSubstr("holds at most 5"));
    std::string infinite = stl;
    const float infinity = std::numeric_limits<float>::infinity();
    std::memcpy(infinite.data() + 84 + 50 + 12, &infinity, sizeof(infinity));
    EXPECT_THAT(message(SurfaceFormat::stl, infinite), HasSubstr("of triangle 1 is not finite"));

    const std::string ply = files()[3].content;
    const auto changed = [&](const std::string& from, const std::string& to) {
        std::string text = ply;
        text.replace(text.find(from), from.size(), to);
        return message(SurfaceFormat::ply, text);
    };
    EXPECT_THAT(changed("ply", "plx"), HasSubstr("not a PLY file"));
    EXPECT_THAT(changed("ascii", "binary"), HasSubstr("line 2: expected ascii, binary_little_endian"));
    EXPECT_THAT(changed("float y", "float w"), HasSubstr("no property y"));
    EXPECT_THAT(changed("vertex 5", "vertex 4"), HasSubstr("line"));
    EXPECT_THAT(changed("vertex 5", "vertex -5"), HasSubstr("negative"));
    EXPECT_THAT(changed("vertex 5", "vertex 999999999"), HasSubstr("holds at most"));
    EXPECT_THAT(changed("vertex_indices", "corners"), HasSubstr("no list vertex_indices"));
    EXPECT_THAT(changed("3 1 2 4", "3 1 2 5"), HasSubstr("face 2 has vertex 5; there are 5"));
    EXPECT_THAT(changed("3 1 2 4", "2 1 2 4"), HasSubstr("face 2 has 2 vertices"));
    EXPECT_THAT(changed("0.5 0.5", "0.5 nan"), HasSubstr("expected a value, a finite number, but found 'nan'"));
    EXPECT_THAT(changed("3 3 0 4\n", "3 3 0"), HasSubstr("the file ends where a value is expected"));
    const std::string binary = files()[4].content;
    EXPECT_THAT(message(SurfaceFormat::ply, binary.substr(0, binary.size() - 1)),
                HasSubstr("the file ends where 2 bytes of a value are expected"));
}

TEST(ReadSurface, DamagedFilesAreReadOrRefused) {
    const std::vector<std::string> words{"-1", "4294967295", "nan", "1e999", "0", "\n", "f ", "v ", "list", "\\\n"};
    std::mt19937 random(20);
    const auto below = [&](std::size_t bound) { return bound == 0 ? 0 : random() % bound; };
    int read = 0, refused = 0;
    for (const File& file : files()) {
        for (int k = 0; k < 2000; ++k) {
            std::string text = file.content;
            for (std::size_t changes = 1 + below(4); changes > 0 && !text.empty(); --changes) {
                const std::size_t at = below(text.size());
                switch (below(4)) {
                    case 0:
                        text[at] = static_cast<char>(below(256));
                        break;
                    case 1:
                        text.resize(at);
                        break;
                    case 2:
                        text.insert(at, text.substr(below(text.size()), below(30)));
                        break;
                    default:
                        text.replace(at, below(4), words[below(words.size())]);
                }
            }
            try {
                const TriangleMesh surface = read_surface_from_memory(file.format, text);
                EXPECT_NO_THROW(require_valid("surface", surface.vertices, surface.triangles));
                EXPECT_FALSE(surface.triangles.empty());
                ++read;
            } catch (const Error& error) {
                EXPECT_THAT(error.what(), HasSubstr("memory: "));
                ++refused;
            }
        }
    }
    EXPECT_GT(read, 500);
    EXPECT_GT(refused, 5000);
}

}  // namespace
}  // namespace lancet::mesh::test
