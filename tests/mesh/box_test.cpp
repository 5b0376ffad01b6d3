#include "lancet/mesh/generate/box.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace {

using lancet::mesh::Box;
using lancet::mesh::Point;
using lancet::mesh::Split;
using lancet::mesh::TetMesh;
using lancet::mesh::Tetrahedron;
using lancet::mesh::Triangle;

constexpr std::array<Triangle, 4> faces{{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};

std::map<Triangle, int> count_faces(const TetMesh& mesh) {
    std::map<Triangle, int> count;
    for (const Tetrahedron& t : mesh.tetrahedra()) {
        for (const Triangle& face : faces) {
            Triangle nodes{t[face[0]], t[face[1]], t[face[2]]};
            std::sort(nodes.begin(), nodes.end());
            ++count[nodes];
        }
    }
    return count;
}

class BoxSplit : public testing::TestWithParam<Split> {};

TEST_P(BoxSplit, IsConformingAndFillsTheBox) {
    const Box box{.cells = {3, 4, 5}, .size = {0.3, 0.8, 2.5}, .split = GetParam(), .origin = {-1, 2, 0.5}};
    const TetMesh mesh = lancet::mesh::box(box);
    EXPECT_EQ(mesh.nodes().size(), 4U * 5U * 6U);
    EXPECT_EQ(mesh.tetrahedra().size(), 60U * (GetParam() == Split::five ? 5U : 6U));
    EXPECT_NEAR(mesh.volume(), 0.6, 1e-14);
    // A face is shared by two elements, or it lies in one of the six sides.
    int outside = 0;
    for (const auto& [face, count] : count_faces(mesh)) {
        ASSERT_LE(count, 2);
        if (count == 2) continue;
        ++outside;
        bool in_side = false;
        for (const auto& [name, side] : mesh.node_sets()) {
            in_side = in_side || std::all_of(face.begin(), face.end(), [&members = side](std::int32_t node) {
                          return std::binary_search(members.begin(), members.end(), node);
                      });
        }
        EXPECT_TRUE(in_side);
    }
    EXPECT_EQ(outside, 2 * 2 * (3 * 4 + 4 * 5 + 5 * 3));
}

TEST_P(BoxSplit, NumbersNodesAlongXFirst) {
    const TetMesh mesh = lancet::mesh::box({.cells = {2, 3, 4}, .size = {2, 3, 4}, .split = GetParam()});
    for (int k = 0; k <= 4; ++k) {
        for (int j = 0; j <= 3; ++j) {
            for (int i = 0; i <= 2; ++i) {
                EXPECT_EQ(mesh.nodes()[i + 3 * (j + 4 * k)], (Point{1.0 * i, 1.0 * j, 1.0 * k}));
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(FiveAndSix, BoxSplit, testing::Values(Split::five, Split::six),
                         [](const auto& instance) { return instance.param == Split::five ? "five" : "six"; });

TEST(Box, HasTheBarsTetrahedraInTheMiddleOfCells) {
    const TetMesh bar = lancet::mesh::box({.cells = {40, 8, 8}, .size = {4, 0.8, 0.8}});
    EXPECT_EQ(bar.tetrahedra().size(), 12800U);
    EXPECT_EQ(bar.nodes().size(), 3321U);
    const std::set<Tetrahedron> elements(bar.tetrahedra().begin(), bar.tetrahedra().end());
    const auto corner = [](int c) { return (c & 1) + 41 * ((c >> 1) & 1) + 41 * 9 * (c >> 2); };
    EXPECT_TRUE(elements.contains({corner(3), corner(5), corner(6), corner(0)}));
    EXPECT_TRUE(elements.contains({corner(1) + 1, corner(2) + 1, corner(4) + 1, corner(7) + 1}));
}

TEST(Box, EqualsTheIndependentMeshOfOtherParity) {
    const std::filesystem::path folder = std::filesystem::path(LANCET_SHARED_DIR) / "reference" / "discrete";
    std::ifstream nodes_file(folder / "mesh_uncut_nodes.csv");
    std::ifstream tets_file(folder / "mesh_uncut_tets.csv");
    if (!nodes_file || !tets_file) GTEST_SKIP() << "no reference mesh in " << folder;

    const TetMesh mesh = lancet::mesh::box({.cells = {4, 8, 26}, .size = {0.03, 0.06, 0.2}, .swap_parity = true});
    std::string line;
    std::getline(nodes_file, line);
    std::size_t node_count = 0;
    char comma = ' ';
    for (std::size_t id = 0; nodes_file >> id; ++node_count) {
        Point x{};
        nodes_file >> comma >> x[0] >> comma >> x[1] >> comma >> x[2];
        ASSERT_LT(id, mesh.nodes().size());
        for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(mesh.nodes()[id][axis], x[axis], 1e-12);
    }
    EXPECT_EQ(node_count, mesh.nodes().size());

    // The reference has 1, 2, 4, 7 in the middle of its even cells: the other parity.
    std::set<Tetrahedron> expected;
    std::getline(tets_file, line);
    while (std::getline(tets_file, line)) {
        std::replace(line.begin(), line.end(), ',', ' ');
        std::istringstream fields(line);
        int id = 0;
        Tetrahedron t{};
        ASSERT_TRUE(fields >> id >> t[0] >> t[1] >> t[2] >> t[3]);
        std::sort(t.begin(), t.end());
        expected.insert(t);
    }
    std::set<Tetrahedron> found;
    for (Tetrahedron t : mesh.tetrahedra()) {
        std::sort(t.begin(), t.end());
        found.insert(t);
    }
    EXPECT_EQ(found.size(), 4160U);
    EXPECT_EQ(found, expected);
}

TEST(Box, RefusesWhatItCannotMesh) {
    using lancet::Error;
    using lancet::mesh::box;
    EXPECT_THROW(box({.cells = {0, 1, 1}}), Error);
    EXPECT_THROW(box({.cells = {1, -3, 1}}), Error);
    EXPECT_THROW(box({.size = {1, 0, 1}}), Error);
    EXPECT_THROW(box({.size = {1, 1, std::nan("")}}), Error);
    EXPECT_THROW(box({.size = {std::numeric_limits<double>::infinity(), 1, 1}}), Error);
    EXPECT_THROW(box({.cells = {2000000000, 2000000000, 2000000000}}), Error);
    EXPECT_THROW(box({.cells = {1000, 1000, 1000}}), Error);
    EXPECT_THROW(box({.cells = {std::numeric_limits<int>::max(), 1, 1}}), Error);
    // Cells far below the spacing of double numbers at the origin asked for.
    EXPECT_THROW(box({.cells = {2, 2, 2}, .size = {1e-9, 1e-9, 1e-9}, .origin = {1e9, 0, 0}}), Error);
}

}  // namespace
