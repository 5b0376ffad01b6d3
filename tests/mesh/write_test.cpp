#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/mesh/io/read.hpp"
#include "lancet/mesh/io/write_msh.hpp"
#include "lancet/mesh/io/write_pvd.hpp"
#include "lancet/mesh/io/write_vtu.hpp"

namespace {

namespace fs = std::filesystem;

using lancet::Error;
using lancet::mesh::MshOptions;
using lancet::mesh::MshVersion;
using lancet::mesh::Point;
using lancet::mesh::read;
using lancet::mesh::TetMesh;
using lancet::mesh::VtuArray;
using testing::HasSubstr;

/// A box with coordinates that have no short decimal form, regions that change often, and awkward names.
TetMesh sample_mesh() {
    auto definition = lancet::mesh::box({.cells = {3, 2, 4}, .size = {1.0 / 3, 0.1, 1e-3}}).definition();
    for (std::size_t t = 0; t < definition.regions.size(); ++t) {
        definition.regions[t] = t % 7 < 3 ? 0 : static_cast<std::int32_t>(t % 3 + 2);
    }
    definition.region_names = {{2, "fat & skin"}, {4, "muscle"}};
    definition.node_sets["a <named> set"] = {5, 6, 7};
    return TetMesh(definition);
}

void expect_same(const TetMesh& found, const TetMesh& expected) {
    EXPECT_TRUE(std::ranges::equal(found.nodes(), expected.nodes()));
    EXPECT_TRUE(std::ranges::equal(found.tetrahedra(), expected.tetrahedra()));
    EXPECT_TRUE(std::ranges::equal(found.regions(), expected.regions()));
    EXPECT_EQ(found.node_sets(), expected.node_sets());
}

std::string content_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

class Write : public testing::Test {
  protected:
    void SetUp() override { fs::create_directories(folder_); }
    void TearDown() override { fs::remove_all(folder_); }

    std::size_t files() const {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
    }

    fs::path folder_ = fs::path(testing::TempDir()) /
                       ("lancet_write_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
};

TEST_F(Write, MshReadsBackEqual) {
    const TetMesh mesh = sample_mesh();
    for (const MshVersion version : {MshVersion::v2_2, MshVersion::v4_1}) {
        for (const bool binary : {false, true}) {
            SCOPED_TRACE(std::string(version == MshVersion::v2_2 ? "2.2" : "4.1") + (binary ? " binary" : " text"));
            lancet::mesh::write_msh(folder_ / "mesh.msh", mesh, {.version = version, .binary = binary});
            const auto result = read(folder_ / "mesh.msh", {.repair = false});
            expect_same(result.mesh, mesh);
            EXPECT_EQ(result.mesh.region_names(), mesh.region_names());
            EXPECT_EQ(files(), 1U);
        }
    }
}

TEST_F(Write, MshRefusesWhatTheFormatCannotHold) {
    auto definition = sample_mesh().definition();
    definition.regions[3] = -2;
    EXPECT_THROW(lancet::mesh::write_msh(folder_ / "mesh.msh", TetMesh(definition)), Error);
    definition = sample_mesh().definition();
    definition.node_sets["a \"quoted\" name"] = {1};
    EXPECT_THROW(lancet::mesh::write_msh(folder_ / "mesh.msh", TetMesh(definition)), Error);
    EXPECT_EQ(files(), 0U);
}

TEST_F(Write, VtuReadsBackEqual) {
    const TetMesh mesh = sample_mesh();
    const std::vector<double> displacement(3 * mesh.nodes().size(), 0.25);
    const std::vector<float> temperature(mesh.nodes().size(), 37.0F);
    const std::vector<double> energy(mesh.tetrahedra().size(), 1e-3);
    const std::vector<std::int32_t> part(mesh.tetrahedra().size(), 4);
    lancet::mesh::write_vtu(folder_ / "mesh.vtu", mesh,
                            {.point_data = {{"displacement", 3, std::span<const double>(displacement)},
                                            {"temperature", 1, std::span<const float>(temperature)}},
                             .cell_data = {{"energy", 1, std::span<const double>(energy)},
                                           {"part", 1, std::span<const std::int32_t>(part)}}});
    expect_same(read(folder_ / "mesh.vtu", {.repair = false}).mesh, mesh);
    EXPECT_EQ(files(), 1U);
    const std::string text = content_of(folder_ / "mesh.vtu");
    EXPECT_THAT(text, HasSubstr(R"(<DataArray type="Float64" Name="displacement" NumberOfComponents="3")"));
    EXPECT_THAT(text, HasSubstr(R"(<DataArray type="Float32" Name="temperature" NumberOfComponents="1")"));
    EXPECT_THAT(text, HasSubstr(R"(<DataArray type="Int32" Name="part" NumberOfComponents="1")"));
    // The arrays lie where the offsets say, each behind its size.
    const std::size_t offset_at = text.find("offset=\"", text.find("Name=\"energy\"")) + 8;
    const std::size_t offset = std::stoul(text.substr(offset_at));
    const char* block = text.data() + text.find("_", text.find("<AppendedData")) + 1 + offset;
    std::uint64_t size = 0;
    std::memcpy(&size, block, sizeof(size));
    EXPECT_EQ(size, energy.size() * sizeof(double));
    EXPECT_EQ(std::memcmp(block + sizeof(size), energy.data(), size), 0);
}

TEST_F(Write, VtuTakesOtherPositions) {
    const TetMesh mesh = lancet::mesh::box({});
    std::vector<Point> moved(mesh.nodes().begin(), mesh.nodes().end());
    for (Point& x : moved) x[1] += 5;
    lancet::mesh::write_vtu(folder_ / "mesh.vtu", mesh, {.positions = moved});
    EXPECT_TRUE(std::ranges::equal(read(folder_ / "mesh.vtu").mesh.nodes(), moved));
}

TEST_F(Write, VtuRefusesArraysThatDoNotFit) {
    const TetMesh mesh = lancet::mesh::box({});
    const std::vector<double> values(8, 0);
    const std::span<const double> all(values);
    const auto write = [&](const lancet::mesh::VtuContent& content) {
        lancet::mesh::write_vtu(folder_ / "mesh.vtu", mesh, content);
    };
    EXPECT_NO_THROW(write({.point_data = {{"t", 1, all}}}));
    EXPECT_THROW(write({.point_data = {{"t", 3, all}}}), Error);
    EXPECT_THROW(write({.point_data = {{"t", 0, all}}}), Error);
    EXPECT_THROW(write({.point_data = {{"t", 1, all}, {"t", 1, all}}}), Error);
    EXPECT_THROW(write({.cell_data = {{"t", 1, all}}}), Error);
    EXPECT_THROW(write({.cell_data = {{"region", 1, all.first(5)}}}), Error);
    const std::vector<Point> few(3);
    EXPECT_THROW(write({.positions = few}), Error);
}

TEST_F(Write, AFileThatCannotBeFinishedLeavesTheOldOne) {
    const TetMesh mesh = lancet::mesh::box({});
    const fs::path path = folder_ / "series.pvd";
    const std::vector<lancet::mesh::PvdFrame> good{{0.0, "frame_0.vtu"}, {0.04, "frame & 1.vtu"}};
    lancet::mesh::write_pvd(path, good);
    const std::string before = content_of(path);
    EXPECT_THAT(before, HasSubstr(R"(<DataSet timestep="0.04" file="frame &amp; 1.vtu"/>)"));
    const std::vector<lancet::mesh::PvdFrame> bad{{0.0, "frame_0.vtu"},
                                                  {std::numeric_limits<double>::quiet_NaN(), "frame_1.vtu"}};
    EXPECT_THROW(lancet::mesh::write_pvd(path, bad), Error);
    EXPECT_EQ(content_of(path), before);
    EXPECT_EQ(files(), 1U);
    EXPECT_THROW(lancet::mesh::write_vtu(folder_ / "absent" / "mesh.vtu", mesh), Error);
    // A folder cannot be replaced by a file.
    fs::create_directories(folder_ / "taken.vtu" / "inside");
    EXPECT_THROW(lancet::mesh::write_vtu(folder_ / "taken.vtu", mesh), Error);
    EXPECT_EQ(files(), 2U);
}

}  // namespace
