// The drawn parts fill the body, and the surface of each piece is closed.
#include "lancet/mesh/cut/part_geometry.hpp"

#include <cmath>
#include <fstream>

#include "tests/experiments/common/temporary_folder.hpp"
#include <gtest/gtest.h>

#include "lancet/mesh/components.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/mesh/io/write_vtu.hpp"

namespace lancet::test {
namespace {

using mesh::CutMesh;
using mesh::CutSurface;
using mesh::Point;

struct Piece {
    double volume = 0;    ///< of the tetrahedra
    double enclosed = 0;  ///< by the surface
    double wall = 0;      ///< area
    double own = 0;       ///< area of the body's own surface
};

std::vector<Piece> pieces(const CutMesh& cut) {
    const mesh::PartGeometry geometry = part_geometry(cut);
    const std::vector<Point> x = place(geometry, cut, cut.rest_positions());
    const auto components = mesh::components(cut.node_of_copy().size(), cut.parts());
    std::vector<Piece> found(static_cast<std::size_t>(components.count));
    const auto of = [&](std::int32_t part) -> Piece& {
        return found[static_cast<std::size_t>(components.of_element[static_cast<std::size_t>(part)])];
    };
    for (std::size_t t = 0; t < geometry.tetrahedra.size(); ++t) {
        const auto& [a, b, c, d] = geometry.tetrahedra[t];
        const double volume = mesh::signed_volume(x[a], x[b], x[c], x[d]);
        EXPECT_GT(volume, 0);
        of(geometry.part_of_tetrahedron[t]).volume += volume;
    }
    for (std::size_t t = 0; t < geometry.triangles.size(); ++t) {
        const auto& [a, b, c] = geometry.triangles[t];
        Piece& piece = of(geometry.part_of_triangle[t]);
        // The cone to a place far outside: a gap or a triangle turned round would not cancel.
        piece.enclosed -= mesh::signed_volume(x[a], x[b], x[c], {5, -3, 7});
        (geometry.is_wall[t] != 0 ? piece.wall : piece.own) += mesh::area(x[a], x[b], x[c]);
    }
    return found;
}

TEST(PartGeometry, FillsTheBodyAndClosesItsPieces) {
    for (const double where : {0.5, 0.3}) {  // along faces, and through elements
        CutMesh cut(mesh::box({.cells = {4, 4, 4}}));
        cut.cut(CutSurface::plane({where, 0, 0}, {1, 0, 0}));
        cut.cut(CutSurface::plane({0, where, 0}, {0, 1, 0}));
        const auto found = pieces(cut);
        ASSERT_EQ(found.size(), 4U);
        double volume = 0, wall = 0, own = 0;
        for (const Piece& piece : found) {
            EXPECT_NEAR(piece.enclosed, piece.volume, 1e-12);
            volume += piece.volume;
            wall += piece.wall;
            own += piece.own;
        }
        EXPECT_NEAR(found[0].volume, where * where, 1e-13);
        EXPECT_NEAR(volume, 1, 1e-13);
        EXPECT_NEAR(wall, 4, 1e-12);  // both sides of two unit squares
        EXPECT_NEAR(own, 6, 1e-12);
    }
}

TEST(PartGeometry, ASweptCutHasWallsOnBothSides) {
    CutMesh cut(mesh::box({.cells = {5, 5, 5}, .split = mesh::Split::six}));
    cut.cut(CutSurface::swept(std::vector<std::array<Point, 2>>{{Point{-1, -1, 0.31}, Point{-1, 2, 0.31}},
                                                                {Point{0.5, -1, 0.42}, Point{0.5, 2, 0.42}},
                                                                {Point{2, -1, 0.31}, Point{2, 2, 0.31}}}));
    const auto found = pieces(cut);
    ASSERT_EQ(found.size(), 2U);
    for (const Piece& piece : found) {
        EXPECT_NEAR(piece.enclosed, piece.volume, 1e-12);
        EXPECT_NEAR(piece.wall, 2 * std::hypot(0.5, 0.11 / 3), 1e-12);
    }
}

TEST(PartGeometry, IsWrittenForParaView) {
    const experiments::test::TemporaryFolder folder;
    CutMesh cut(mesh::box({.cells = {2, 2, 2}}));
    cut.cut(CutSurface::plane({0.3 + 1e-9, 0.2, 0}, {1, 1, 0}));
    const mesh::PartGeometry geometry = part_geometry(cut);
    const std::vector<Point> x = place(geometry, cut, cut.rest_positions());
    std::vector<std::int32_t> part = geometry.part_of_tetrahedron;
    part.insert(part.end(), geometry.part_of_triangle.begin(), geometry.part_of_triangle.end());
    const auto file = folder.path() / "cut.vtu";
    mesh::write_vtu(file, {.points = x, .tetrahedra = geometry.tetrahedra, .triangles = geometry.triangles},
                    {.cell_data = {{"part", 1, std::span<const std::int32_t>(part)}}});
    std::ifstream stream(file, std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    EXPECT_NE(text.find("NumberOfPoints=\"" + std::to_string(x.size()) + "\""), std::string::npos);
    EXPECT_NE(text.find("NumberOfCells=\"" + std::to_string(part.size()) + "\""), std::string::npos);
}

}  // namespace
}  // namespace lancet::test
