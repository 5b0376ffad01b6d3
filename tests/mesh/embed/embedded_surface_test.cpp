// A fine closed surface in coarse elements is cut: pieces stay closed, nothing is lost, and nothing stretches across.
#include "lancet/mesh/embed/embedded_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/mesh/surface/shapes.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/components.hpp"
#include "lancet/mesh/embed/embedding.hpp"
#include "lancet/mesh/generate/around.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/mesh/surface/vertex_normals.hpp"

namespace lancet::mesh::test {
namespace {

/// What is intersected is moved by 2^-36 of the surface's size, and corners within 2^-24 of an element are one: areas
/// and volumes are known to a few of these where thin pieces are lost, and to rounding where there are none.
constexpr double lost = 1e-6;

TetMesh grid(int cells, Split split = Split::five) {
    return box({.cells = {cells, cells, cells}, .split = split});
}

struct Piece {
    std::vector<Triangle> triangles{};
    double volume = 0, wall = 0;
};

/// The pieces of the body by what hangs together, each of which must be closed.
std::vector<Piece> pieces(const EmbeddedSurface& surface, const CutMesh& cut) {
    const Components components = mesh::components(cut.node_of_copy().size(), cut.parts());
    const auto of_vertex = [&](std::int32_t v) {
        return components.of_element[static_cast<std::size_t>(surface.points()[static_cast<std::size_t>(v)].part)];
    };
    std::vector<Piece> found(static_cast<std::size_t>(components.count));
    for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
        const auto& [a, b, c] = surface.triangles()[t];
        EXPECT_EQ(of_vertex(a), of_vertex(b));
        EXPECT_EQ(of_vertex(a), of_vertex(c));
        Piece& piece = found[static_cast<std::size_t>(of_vertex(a))];
        piece.triangles.push_back({a, b, c});
        if (surface.is_wall()[t] == 0) continue;
        const auto x = surface.at_rest();
        piece.wall +=
            area(x[static_cast<std::size_t>(a)], x[static_cast<std::size_t>(b)], x[static_cast<std::size_t>(c)]);
    }
    std::erase_if(found, [](const Piece& piece) { return piece.triangles.empty(); });
    for (Piece& piece : found) {
        const SurfaceTopology topology = surface_topology(surface.points().size(), piece.triangles);
        EXPECT_TRUE(topology.is_boundary()) << topology.unmatched_edges << " unmatched of " << piece.triangles.size();
        EXPECT_EQ(topology.empty_triangles, 0);
        piece.volume = signed_volume(surface.at_rest(), piece.triangles);
    }
    std::sort(found.begin(), found.end(), [](const Piece& a, const Piece& b) { return a.volume < b.volume; });
    return found;
}

double total_volume(const std::vector<Piece>& found) {
    double sum = 0;
    for (const Piece& piece : found) sum += piece.volume;
    return sum;
}

double enclosed(const TriangleMesh& surface) {
    return signed_volume(surface.vertices, surface.triangles);
}

/// Moves every component of the mesh by an offset of its own and looks whether a triangle has changed its sides.
void expect_no_stretch(const EmbeddedSurface& surface, const CutMesh& cut) {
    const Components components = mesh::components(cut.node_of_copy().size(), cut.parts());
    std::vector<Point> positions = cut.rest_positions();
    for (std::size_t copy = 0; copy < positions.size(); ++copy) {
        positions[copy][0] += 10.0 * components.of_node[copy];
        positions[copy][1] -= 3.0 * components.of_node[copy];
    }
    std::vector<Point> places(surface.points().size());
    place(surface.copies(), surface.weights(), positions, places);
    const auto length = [](std::span<const Point> x, std::int32_t a, std::int32_t b) {
        const Point &p = x[static_cast<std::size_t>(a)], &q = x[static_cast<std::size_t>(b)];
        return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
    };
    double worst = 0;
    for (const Triangle& t : surface.triangles()) {
        for (std::size_t k = 0; k < 3; ++k) {
            worst = std::max(worst, std::abs(length(places, t[k], t[(k + 1) % 3]) -
                                             length(surface.at_rest(), t[k], t[(k + 1) % 3])));
        }
    }
    EXPECT_LT(worst, 1e-12 * static_cast<double>(components.count + 1));
}

TEST(EmbeddedSurface, FollowsTheMeshWithoutCuts) {
    const CutMesh cut(grid(3));
    const TriangleMesh ball = sphere({0.5, 0.5, 0.5}, 0.4, 3);
    const EmbeddedSurface surface(cut, ball);
    EXPECT_TRUE(std::ranges::equal(surface.triangles(), ball.triangles));
    std::vector<Point> places(surface.points().size());
    place(surface.copies(), surface.weights(), cut.rest_positions(), places);
    for (std::size_t v = 0; v < places.size(); ++v) {
        for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(places[v][axis], ball.vertices[v][axis], 1e-15);
    }
}

TEST(EmbeddedSurface, APlaneMakesTwoClosedHalves) {
    for (const Split split : {Split::five, Split::six}) {
        // Through elements; along faces and through vertices of the sphere; close to these.
        for (const double where : {0.55, 0.5, 0.5 + 1e-13, 0.5 + 1e-6, 0.25}) {
            SCOPED_TRACE(where);
            CutMesh cut(grid(4, split));
            const TriangleMesh ball = sphere({0.5, 0.5, 0.5}, 0.4, 3);
            EmbeddedSurface surface(cut, ball);
            cut.cut(CutSurface::plane({where, 0, 0}, {1, 0, 0}));
            EXPECT_TRUE(surface.update(cut));
            EXPECT_FALSE(surface.update(cut));
            const std::vector<Piece> found = pieces(surface, cut);
            ASSERT_EQ(found.size(), 2U);
            EXPECT_NEAR(total_volume(found), enclosed(ball), lost);
            EXPECT_NEAR(found[0].wall, found[1].wall, lost);
            if (where == 0.5) {  // the section is a regular polygon of 32 corners
                EXPECT_NEAR(found[0].wall, 16 * 0.16 * std::sin(std::numbers::pi / 16), lost);
                EXPECT_NEAR(found[0].volume, enclosed(ball) / 2, lost);
            }
            expect_no_stretch(surface, cut);
        }
    }
}

TEST(EmbeddedSurface, SectionsHaveTheAreaOfTheSurfacesSection) {
    // The section of the triangles with the plane, by the divergence theorem in the plane: 1/2 int x . n ds.
    CutMesh cut(grid(5));
    const TriangleMesh ring = torus({0.5, 0.5, 0.5}, 0.28, 0.12, 48, 24);
    const Point normal{0.6, 0.8, 0};
    const Point origin{0.51, 0.49, 0.5};
    const auto height = [&](const Point& x) {
        return normal[0] * (x[0] - origin[0]) + normal[1] * (x[1] - origin[1]) + normal[2] * (x[2] - origin[2]);
    };
    double section = 0;
    for (const Triangle& t : ring.triangles) {
        std::vector<Point> ends;
        for (std::size_t k = 0; k < 3; ++k) {
            const Point &a = ring.vertices[static_cast<std::size_t>(t[k])],
                        &b = ring.vertices[static_cast<std::size_t>(t[(k + 1) % 3])];
            if ((height(a) > 0) == (height(b) > 0)) continue;
            const double s = height(a) / (height(a) - height(b));
            Point p{};
            for (std::size_t axis = 0; axis < 3; ++axis) p[axis] = a[axis] + s * (b[axis] - a[axis]) - origin[axis];
            if (height(a) > 0) {
                ends.insert(ends.begin(), p);
            } else {
                ends.push_back(p);
            }
        }
        if (ends.size() != 2) continue;
        const Point &p = ends[0], &q = ends[1];
        section += (normal[0] * (p[1] * q[2] - p[2] * q[1]) + normal[1] * (p[2] * q[0] - p[0] * q[2]) +
                    normal[2] * (p[0] * q[1] - p[1] * q[0])) /
                   2;
    }
    EmbeddedSurface surface(cut, ring);
    cut.cut(CutSurface::plane(origin, normal));
    surface.update(cut);
    const std::vector<Piece> found = pieces(surface, cut);
    ASSERT_EQ(found.size(), 2U);
    EXPECT_NEAR(found[0].wall, std::abs(section), lost);
    EXPECT_NEAR(found[1].wall, std::abs(section), lost);
    EXPECT_NEAR(total_volume(found), enclosed(ring), lost);
    expect_no_stretch(surface, cut);
}

TEST(EmbeddedSurface, ACutHalfThroughLeavesOneClosedSurface) {
    for (const double where : {0.53, 0.5}) {
        SCOPED_TRACE(where);
        CutMesh cut(grid(6));
        const TriangleMesh ball = sphere({0.5, 0.5, 0.5}, 0.4, 3);
        EmbeddedSurface surface(cut, ball);
        cut.cut(CutSurface::half_plane({where, 0, 0.47}, {1, 0, 0}, {0, 0, 1}));
        surface.update(cut);
        const std::vector<Piece> found = pieces(surface, cut);
        ASSERT_EQ(found.size(), 1U);
        EXPECT_NEAR(found[0].volume, enclosed(ball), lost);
        EXPECT_GT(found[0].wall, 0.3);  // both sides of most of half a disc
        EXPECT_LT(found[0].wall, 0.5);
        // Opened: the copies above the front go apart, and the surface stays closed around more volume.
        std::vector<Point> positions = cut.rest_positions();
        for (std::size_t part = 0; part < cut.parts().size(); ++part) {
            for (std::size_t k = 0; k < 4; ++k) {
                const auto copy = static_cast<std::size_t>(cut.parts()[part][k]);
                const auto node = static_cast<std::size_t>(cut.node_of_copy()[copy]);
                if (cut.copies_of_node(static_cast<std::int32_t>(node)).size() < 2) continue;
                const double side = copy == node ? -1 : 1;
                positions[copy][0] = cut.mesh().nodes()[node][0] + side * 1e-3;
            }
        }
        std::vector<Point> places(surface.points().size());
        place(surface.copies(), surface.weights(), positions, places);
        const double moved = signed_volume(places, surface.triangles());
        EXPECT_TRUE(std::isfinite(moved));
        EXPECT_NE(moved, found[0].volume);
    }
}

TEST(EmbeddedSurface, CrossingCutsMakeClosedPieces) {
    for (const double where : {0.52, 0.5}) {
        SCOPED_TRACE(where);
        CutMesh cut(grid(4, Split::six));
        const TriangleMesh ball = sphere({0.5, 0.5, 0.5}, 0.4, 3);
        EmbeddedSurface surface(cut, ball);
        const std::vector<Point> normals{{1, 0, 0}, {0, 1, 0}, {0.3, 0.4, 1}};
        std::size_t expected = 1;
        for (const Point& normal : normals) {
            cut.cut(CutSurface::plane({where, where, where}, normal));
            surface.update(cut);
            expected *= 2;
            const std::vector<Piece> found = pieces(surface, cut);
            EXPECT_EQ(found.size(), expected);
            EXPECT_NEAR(total_volume(found), enclosed(ball), lost);
            expect_no_stretch(surface, cut);
        }
        EXPECT_EQ(surface.topology_version(), 4U);
    }
}

TEST(EmbeddedSurface, VerticesKeepTheirNumbers) {
    CutMesh cut(grid(5));
    const TriangleMesh ball = sphere({0.5, 0.5, 0.5}, 0.4, 3);
    EmbeddedSurface surface(cut, ball);
    std::vector<Point> before(surface.at_rest().begin(), surface.at_rest().end());
    for (int k = 0; k < 5; ++k) {
        cut.cut(CutSurface::half_plane({0.3 + 0.1 * k, 0.02, 0.2 * k}, {1, 0.1 * k, 0}, {0, 0, 1}));
        surface.update(cut);
        pieces(surface, cut);
        ASSERT_GE(surface.points().size(), before.size());
        double worst = 0;
        for (std::size_t v = 0; v < before.size(); ++v) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                worst = std::max(worst, std::abs(surface.at_rest()[v][axis] - before[v][axis]));
            }
        }
        EXPECT_LT(worst, 1e-7);  // corners within 2^-24 of an element are one
        before.assign(surface.at_rest().begin(), surface.at_rest().end());
    }
}

TEST(EmbeddedSurface, ProgressiveCutsEndLikeOneCut) {
    const TriangleMesh ball = sphere({0.5, 0.5, 0.5}, 0.4, 3);
    CutMesh cut(grid(4));
    EmbeddedSurface surface(cut, ball);
    constexpr int strokes = 7;
    for (int k = 0; k < strokes; ++k) {
        const double from = k / static_cast<double>(strokes), to = (k + 1) / static_cast<double>(strokes);
        cut.cut(CutSurface::parallelogram({0.53, -0.1, from}, {0, 1.2, 0}, {0, 0, to - from}));
        surface.update(cut);
        const std::vector<Piece> found = pieces(surface, cut);
        EXPECT_NEAR(total_volume(found), enclosed(ball), lost);
    }
    CutMesh at_once(grid(4));
    at_once.cut(CutSurface::plane({0.53, 0, 0}, {1, 0, 0}));
    const EmbeddedSurface other(at_once, ball);
    const std::vector<Piece> found = pieces(surface, cut), expected = pieces(other, at_once);
    ASSERT_EQ(found.size(), 2U);
    ASSERT_EQ(expected.size(), 2U);
    for (std::size_t k = 0; k < 2; ++k) {
        EXPECT_NEAR(found[k].volume, expected[k].volume, lost);
        EXPECT_NEAR(found[k].wall, expected[k].wall, lost);
    }
    expect_no_stretch(surface, cut);
}

TEST(EmbeddedSurface, RandomCutsLeaveClosedPieces) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int sequence = 0; sequence < 30; ++sequence) {
        SCOPED_TRACE(sequence);
        const TriangleMesh shape =
            sequence % 2 == 0 ? sphere({0.5, 0.5, 0.5}, 0.4, 2) : torus({0.5, 0.5, 0.5}, 0.28, 0.12, 16, 8);
        CutMesh cut(around(shape, {.cell_size = sequence % 3 == 0 ? 0.3 : 0.17,
                                   .split = sequence % 4 < 2 ? Split::five : Split::six}));
        EmbeddedSurface surface(cut, shape);
        for (int k = 0; k < 4; ++k) {
            const auto near = [&] { return 0.5 + 0.2 * uniform(random); };
            const Point point{near(), near(), near()}, normal{uniform(random), uniform(random), uniform(random)};
            const Point inward{uniform(random), uniform(random), uniform(random)};
            switch (k % 3) {
                case 0:
                    cut.cut(CutSurface::plane(point, normal));
                    break;
                case 1:
                    cut.cut(CutSurface::half_plane(point, normal, inward));
                    break;
                default:
                    cut.cut(CutSurface::parallelogram(point, normal, inward));
            }
            surface.update(cut);
            EXPECT_NEAR(total_volume(pieces(surface, cut)), enclosed(shape), lost);
            expect_no_stretch(surface, cut);
        }
    }
}

TEST(EmbeddedSurface, NormalsAreThoseOfPieces) {
    CutMesh cut(grid(4));
    const TriangleMesh ball = sphere({0.5, 0.5, 0.5}, 0.4, 4);
    EmbeddedSurface surface(cut, ball);
    const VertexCorners before(surface.points().size(), surface.triangles());
    std::vector<Point> normals(surface.points().size());
    vertex_normals(before, surface.at_rest(), 0, normals.size(), normals);
    cut.cut(CutSurface::plane({0.53, 0, 0}, {1, 0, 0}));
    surface.update(cut);
    const VertexCorners after(surface.points().size(), surface.triangles());
    std::vector<Point> cut_normals(surface.points().size());
    vertex_normals(after, surface.at_rest(), 0, cut_normals.size(), cut_normals);
    for (std::size_t v = 0; v < normals.size(); ++v) {
        if (std::abs(ball.vertices[v][0] - 0.53) < 0.05) continue;
        for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(cut_normals[v][axis], normals[v][axis], 1e-6);
    }
}

TEST(EmbeddedSurface, OpenSurfacesAreDividedWithoutWalls) {
    TriangleMesh open = sphere({0.5, 0.5, 0.5}, 0.4, 3);
    open.triangles.erase(open.triangles.begin(), open.triangles.begin() + 100);
    CutMesh cut(grid(4));
    EmbeddedSurface surface(cut, open);
    cut.cut(CutSurface::plane({0.53, 0, 0}, {1, 0, 0}));
    surface.update(cut);
    EXPECT_EQ(std::ranges::count(surface.is_wall(), 1), 0);
    EXPECT_NEAR(area(surface.at_rest(), surface.triangles()), area(open.vertices, open.triangles), lost);
    expect_no_stretch(surface, cut);
}

TEST(EmbeddedSurface, BadInputIsRefused) {
    const CutMesh cut(grid(2));
    EXPECT_THROW(EmbeddedSurface(cut, sphere({0.5, 0.5, 0.5}, 0.6, 2)), Error);
    TriangleMesh bad = sphere({0.5, 0.5, 0.5}, 0.4, 1);
    bad.vertices[0][0] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(EmbeddedSurface(cut, bad), Error);
    TriangleMesh overused = sphere({0.5, 0.5, 0.5}, 0.4, 1);
    overused.triangles.push_back(overused.triangles[0]);
    EXPECT_THROW(EmbeddedSurface(cut, overused), Error);
    EmbeddedSurface surface(cut, sphere({0.5, 0.5, 0.5}, 0.4, 1));
    EXPECT_THROW(surface.update(CutMesh(grid(3))), Error);
    EXPECT_FALSE(surface.update(cut));
}

}  // namespace
}  // namespace lancet::mesh::test
