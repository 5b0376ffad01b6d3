#include "lancet/mesh/io/read.hpp"

#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "tests/mesh/samples.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/components.hpp"

namespace {

using lancet::Error;
using lancet::mesh::MeshFormat;
using lancet::mesh::Point;
using lancet::mesh::read;
using lancet::mesh::read_from_memory;
using lancet::mesh::ReadResult;
using lancet::mesh::Tetrahedron;
using lancet::mesh::test::Sample;
using lancet::mesh::test::samples;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const Sample& sample(const std::string& name) {
    static const std::vector<Sample> all = samples();
    for (const Sample& one : all) {
        if (one.name == name) return one;
    }
    throw Error("no sample " + name);
}

ReadResult read_sample(const Sample& one, const lancet::mesh::ReadOptions& options = {}) {
    return read_from_memory(one.format, one.content, one.second, "file", options);
}

/// The sample with one piece of text replaced; the piece must be there.
Sample changed(const std::string& name, const std::string& from, const std::string& to) {
    Sample one = sample(name);
    const bool in_second = one.content.find(from) == std::string::npos;
    std::string& text = in_second ? one.second : one.content;
    const std::size_t place = text.find(from);
    if (place == std::string::npos) throw std::logic_error("no '" + from + "' in " + name);
    text.replace(place, from.size(), to);
    return one;
}

std::string error_of(const Sample& one) {
    try {
        read_sample(one);
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

TEST(Read, EveryVariantOfEveryFormat) {
    for (const Sample& one : samples()) {
        SCOPED_TRACE(one.name);
        const ReadResult result = read_sample(one);
        EXPECT_THAT(result.mesh.nodes(),
                    ElementsAre(Point{0, 0, 0}, Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}, Point{1, 1, 1.25}));
        EXPECT_THAT(result.mesh.tetrahedra(), ElementsAre(Tetrahedron{0, 1, 2, 3}, Tetrahedron{1, 2, 3, 4}));
        EXPECT_THAT(result.mesh.regions(), ElementsAre(3, 7));
    }
}

TEST(Read, GroupsAndSetsKeepTheirNames) {
    for (const char* name : {"gmsh 2.2 text", "gmsh 2.2 binary big", "gmsh 4.1 text", "gmsh 4.1 binary little"}) {
        SCOPED_TRACE(name);
        const ReadResult result = read_sample(sample(name));
        EXPECT_EQ(result.mesh.region_names(), (std::map<int, std::string>{{3, "liver"}, {7, "vessel"}}));
        EXPECT_THAT(result.mesh.node_set("skin"), ElementsAre(0, 1, 2));
        EXPECT_THAT(result.notes, ElementsAre("skipped cells of lower dimension: 1 triangles"));
    }
    EXPECT_THAT(read_sample(sample("gmsh 1")).mesh.node_set("physical_2_5"), ElementsAre(0, 1, 2));
    EXPECT_THAT(read_sample(sample("vtu raw little UInt32")).mesh.node_set("held & fixed"), ElementsAre(0, 4));

    const ReadResult tetgen = read_sample(sample("tetgen"));
    EXPECT_THAT(tetgen.mesh.node_set("marker_1"), ElementsAre(0));
    EXPECT_THAT(tetgen.mesh.node_set("marker_2"), ElementsAre(4));

    const ReadResult abaqus = read_sample(sample("abaqus"));
    EXPECT_THAT(abaqus.mesh.node_set("ALL"), ElementsAre(0, 1, 2, 3, 4));
    EXPECT_THAT(abaqus.mesh.node_set("base"), ElementsAre(0, 1, 2));
    EXPECT_THAT(abaqus.mesh.node_set("held"), ElementsAre(0, 1, 2, 4));
    EXPECT_EQ(abaqus.mesh.region_names().at(7), "second");
}

TEST(Read, AbaqusElementSetsAreRegionsWhereThereAreNoSections) {
    const ReadResult result =
        read_from_memory(MeshFormat::abaqus,
                         "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,1,1,1\n*ELEMENT,TYPE=C3D4,ELSET=a\n1,1,2,3,4\n"
                         "*ELEMENT,TYPE=C3D4,ELSET=b\n2,2,3,4,5\n");
    EXPECT_THAT(result.mesh.regions(), ElementsAre(1, 2));
    EXPECT_EQ(result.mesh.region_names(), (std::map<int, std::string>{{1, "a"}, {2, "b"}}));
}

TEST(Read, ScalesCoordinates) {
    const ReadResult result = read_sample(sample("gmsh 1"), {.scale = 0.01});
    EXPECT_EQ(result.mesh.nodes()[4], (Point{0.01, 0.01, 0.0125}));
    EXPECT_THROW(read_sample(sample("gmsh 1"), {.scale = 0}), Error);
}

TEST(Read, RepairsAndSaysSo) {
    const Sample inverted = changed("tetgen", "1  1 2 3 4  3", "1  2 1 3 4  3");
    const ReadResult result = read_sample(inverted);
    EXPECT_THAT(result.notes, ElementsAre(HasSubstr("turned 1 of 2 elements")));
    EXPECT_THROW(read_sample(inverted, {.repair = false}), Error);

    Sample unused = changed("tetgen", "5 3 1 1", "6 3 1 1");
    unused.content += "6 9 9 9 0.5 0\n";
    EXPECT_THAT(read_sample(unused).notes, ElementsAre(HasSubstr("dropped 1 of 6 nodes")));
    EXPECT_THROW(read_sample(unused, {.repair = false}), Error);

    const Sample flat = changed("gmsh 1", "9 1 1 1.25", "9 0.5 0.5 0");
    EXPECT_THAT(error_of(flat), AllOf(HasSubstr("file: "), HasSubstr("1 of 2 elements flat")));
    EXPECT_THAT(read_sample(flat, {.drop_flat = true}).mesh.tetrahedra(), ElementsAre(Tetrahedron{0, 1, 2, 3}));

    const Sample twice = changed("gmsh 1", "4 2 3 4 9", "4 2 3 4 1");
    EXPECT_THAT(error_of(twice), HasSubstr("repeat an earlier one"));
    EXPECT_EQ(read_sample(twice, {.drop_duplicates = true}).mesh.tetrahedra().size(), 1U);
}

TEST(Read, SeveralPiecesOfAGridBecomeOneMesh) {
    Sample one = sample("vtu ascii little UInt32");
    const std::size_t begin = one.content.find("<Piece");
    const std::size_t end = one.content.find("</Piece>") + 8;
    std::string second = one.content.substr(begin, end - begin);
    second.replace(second.find("0 0 0  1 0 0  0 1 0  0 0 1  1 1 1.25"), 36, "5 5 5  6 5 5  5 6 5  5 5 6  6 6 6.25");
    one.content.insert(end, second);
    const ReadResult result = read_sample(one);
    EXPECT_EQ(result.mesh.nodes().size(), 10U);
    EXPECT_THAT(result.mesh.regions(), ElementsAre(3, 7, 3, 7));
    EXPECT_THAT(result.mesh.node_set("held & fixed"), ElementsAre(0, 4, 5, 9));
    EXPECT_EQ(lancet::mesh::components(result.mesh).count, 2);
}

struct Fault {
    const char* sample;
    const char* from;
    const char* to;
    const char* place;
    const char* message;
};

TEST(Read, FaultsNameTheFileThePlaceAndWhatWasExpected) {
    const Fault faults[] = {
        {"gmsh 1", "9 1 1 1.25", "9 1 nan 1.25", "line 7", "a finite number, but found 'nan'"},
        {"gmsh 1", "9 1 1 1.25", "9 1 1e999 1.25", "line 7", "a finite number"},
        {"gmsh 1", "2 3 4 9", "2 3 4 8", "line 13", "names node 8, which is not in the file"},
        {"gmsh 1", "$NOD\n5", "$NOD\n6", "line 8", "an integer, but found '$ENDNOD'"},
        {"gmsh 1", "$NOD\n5", "$NOD\n4", "line 7", "expected $ENDNOD, but found '9'"},
        {"gmsh 1", "$NOD\n5", "$NOD\n4000000000", "line 2", "holds at most"},
        {"gmsh 1", "$NOD\n5", "$NOD\n-5", "line 2", "negative"},
        {"gmsh 1", "2 1 0 0", "1 1 0 0", "line", "node number 1 occurs twice"},
        {"gmsh 1", "3 4 7 1 4 2", "3 4 7 1 5 2", "line 13", "expected 4"},
        {"gmsh 1", "3 4 7 1 4 2", "3 99 7 1 5 2", "line 13", "element type 99"},
        {"gmsh 1", "1 2 5 5 3 1 2 3", "1 5 5 5 8 1 2 3 4 1 2 3 4", "file: ", "1 hexahedra"},
        {"gmsh 2.2 text", "2.2 0 8", "4 0 8", "line 2", "Gmsh format version '4'"},
        {"gmsh 2.2 text", "2.2 0 8", "2.2 0 4", "line 2", "expected 8"},
        {"gmsh 2.2 text", "$EndElements", "$EndNodes", "line", "expected $EndElements"},
        {"gmsh 4.1 text", "$Nodes\n2 5", "$Nodes\n2 6", "line", "the section announced 6"},
        {"gmsh 4.1 text", "3 1 0 3\n", "3 1 0 300\n", "line 24", "holds at most"},
        {"gmsh 4.1 text", "3 1 4 1\n", "2 1 4 1\n", "line", "tetrahedra in an entity of dimension 2"},
        {"gmsh 2.2 binary little", "$EndNodes", "$EndNodez", "line", "expected $EndNodes"},
        {"vtk text", "POINTS 5", "POINTS 5000000000", "line 5", "holds at most"},
        {"vtk text", "POINTS 5", "POINTS 6", "line 9", "a finite number, but found 'CELLS'"},
        {"vtk text", "4 1 2 3 4", "4 1 2 3 5", "line", "node 5 is not one of the 5 points"},
        {"vtk text", "CELLS 3 14", "CELLS 3 13", "line", "does not fit"},
        {"vtk text", "10 5 10", "10 5 11", "line", "expected 8"},
        {"vtk text", "CELL_TYPES 3\n10 5 10", "CELL_TYPES 2\n10 5", "line", "2 cell types for 3 cells"},
        {"vtk text", "UNSTRUCTURED_GRID", "POLYDATA", "line 4", "'POLYDATA'"},
        {"vtu ascii little UInt32", "1 1 1.25", "1 1 inf", "line", "but found 'inf'"},
        {"vtu ascii little UInt32", "1 1 1.25", "1 1", "line", "the file ends where"},
        {"vtu ascii little UInt32", "1 1 1.25", "1 1 1.25 7", "line", "but found '7'"},
        {"vtu ascii little UInt32", "1 2 3 4\n", "1 2 3 5\n", "line", "node 5 is not one of the 5 points"},
        {"vtu ascii little UInt32", "NumberOfPoints=\"5\"", "NumberOfPoints=\"2000000000\"", "line", "holds at most"},
        {"vtu ascii little UInt32", "</Cells>", "</Cell>", "line", "not well-formed XML"},
        {"vtu ascii little UInt32", "4 7 11", "4 7 1000000000", "line", "the last offset is 1000000000"},
        {"vtu ascii little UInt32 zlib", "vtkZLib", "vtkLZ4", "line 3", "'vtkLZ4DataCompressor'"},
        {"vtu raw little UInt32", "NumberOfPoints=\"5\"", "NumberOfPoints=\"4\"", "line", "expected 4"},
        {"vtu raw little UInt32 zlib", "NumberOfPoints=\"5\"", "NumberOfPoints=\"1900000000\"", "line", "zlib"},
        {"vtu raw little UInt32", "offset=\"0\"", "offset=\"99999\"", "line", "offset '99999'"},
        {"tetgen", "5 3 1 1", "5 2 1 1", "line 2", "expected 3"},
        {"tetgen", "5 3 1 1", "7 3 1 1", "line 9", "the file ends where a node"},
        {"tetgen", "2 4 1", "2 10 1", "line 1", "10 nodes"},
        {"tetgen", "2  2 3 4 5  7", "2  2 3 4 6  7", "line 3", "names node 6"},
        {"tetgen", "2  2 3 4 5  7", "2  2 3 4 5  7 8", "line 3", "but found '8'"},
        {"abaqus", "3, 20, 30, 40, 50", "3, 20, 30, 40, 60", "line 15", "names node 60"},
        {"abaqus", "3, 20, 30, 40, 50", "3, 20, 30, 40", "line 15", "four nodes"},
        {"abaqus", "10, 30, 10", "10, 900000000000, 1", "line 17", "not all in the file"},
        {"abaqus", "TYPE=S3", "TYPE=C3D8", "file: ", "1 'C3D8' elements"},
        {"abaqus", "50, base,", "50, bass,", "line 19", "'bass', which is not known"},
        {"abaqus", "50, 1., 1., 1.25", "50, 1., 1.", "line 9", "three coordinates"},
    };
    for (const Fault& fault : faults) {
        SCOPED_TRACE(std::string(fault.sample) + ": " + fault.to);
        const std::string error = error_of(changed(fault.sample, fault.from, fault.to));
        EXPECT_THAT(error, AllOf(HasSubstr("file"), HasSubstr(fault.place), HasSubstr(fault.message)));
        EXPECT_EQ(error.find('\n'), std::string::npos);
    }
}

TEST(Read, TruncatedFilesAreRefused) {
    for (const Sample& one : samples()) {
        SCOPED_TRACE(one.name);
        // What is cut off here always holds a part of the mesh.
        for (const double part : {0.0, 0.1, 0.2, 0.3}) {
            Sample cut = one;
            cut.content.resize(static_cast<std::size_t>(part * static_cast<double>(one.content.size())));
            EXPECT_NE(error_of(cut), "no error");
        }
    }
}

TEST(Read, EmptyInputIsRefused) {
    for (const MeshFormat format :
         {MeshFormat::gmsh, MeshFormat::vtk_legacy, MeshFormat::vtk_xml, MeshFormat::tetgen, MeshFormat::abaqus}) {
        EXPECT_THROW(read_from_memory(format, ""), Error);
        EXPECT_THROW(read_from_memory(format, " \n\n"), Error);
    }
}

class ReadFile : public testing::Test {
  protected:
    void SetUp() override { std::filesystem::create_directories(folder_); }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path write(const std::string& name, const std::string& content) const {
        std::ofstream(folder_ / name, std::ios::binary) << content;
        return folder_ / name;
    }

    std::filesystem::path folder_ =
        std::filesystem::path(testing::TempDir()) /
        ("lancet_read_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
};

TEST_F(ReadFile, TheFormatFollowsFromContentAndExtension) {
    const std::map<MeshFormat, std::string> extensions{{MeshFormat::gmsh, ".msh"},
                                                       {MeshFormat::vtk_legacy, ".vtk"},
                                                       {MeshFormat::vtk_xml, ".vtu"},
                                                       {MeshFormat::tetgen, ".node"},
                                                       {MeshFormat::abaqus, ".inp"}};
    for (const Sample& one : samples()) {
        SCOPED_TRACE(one.name);
        const auto path = write("mesh" + extensions.at(one.format), one.content);
        if (one.format == MeshFormat::tetgen) {
            EXPECT_EQ(read(write("mesh.ele", one.second)).mesh.tetrahedra().size(), 2U);
        }
        EXPECT_EQ(read(path).mesh.tetrahedra().size(), 2U);
        if (one.format == MeshFormat::tetgen || one.format == MeshFormat::abaqus) continue;
        EXPECT_EQ(read(write("mesh.dat", one.content)).mesh.tetrahedra().size(), 2U);
    }
}

TEST_F(ReadFile, WhatCannotBeOpenedIsNamed) {
    EXPECT_THROW(read(folder_), Error);
    EXPECT_THROW(read(folder_ / "absent.msh"), Error);
    EXPECT_THROW(read(write("lonely.node", "1 3\n1 0 0 0\n")), Error);
    EXPECT_THROW(read(write("letter.txt", "Dear reader,\n")), Error);
    try {
        read(folder_ / "absent.msh");
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr("absent.msh: cannot be opened"));
    }
}

TEST(SharedMeshes, AllLoad) {
    const std::filesystem::path folder = std::filesystem::path(LANCET_SHARED_DIR) / "meshes";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no meshes in " << folder;
    const ReadResult raptor = read(folder / "raptorTetra_19409.vtu");
    EXPECT_EQ(raptor.mesh.tetrahedra().size(), 19409U);
    EXPECT_EQ(raptor.mesh.nodes().size(), 5990U);
    EXPECT_THAT(raptor.notes, ElementsAre(HasSubstr("dropped 2 of 5992 nodes")));
    const ReadResult tongue = read(folder / "volumetricTongue.vtu");
    EXPECT_EQ(tongue.mesh.tetrahedra().size(), 10980U);
    EXPECT_EQ(tongue.mesh.nodes().size(), 2238U);
    EXPECT_THAT(tongue.notes, IsEmpty());
    const ReadResult liver = read(folder / "liver.msh");
    EXPECT_EQ(liver.mesh.nodes().size(), 181U);
    EXPECT_EQ(liver.mesh.tetrahedra().size(), 596U);
    EXPECT_GT(liver.mesh.volume(), 0);
}

}  // namespace
