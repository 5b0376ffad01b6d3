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

/// What is intersected is moved by up to 2^-36 of the surface's size, and corners within 2^-24 of an element are one:
/// areas and volumes are known to a few of these where thin pieces are lost, and to rounding where there are none.
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

TEST(EmbeddedSurface, WallsInsideOfOneElementHaveHoles) {
    // Five elements carry all of a ring, whose section lies within the middle one and does not reach its border.
    const TriangleMesh ring = torus({0.5, 0.5, 0.5}, 0.06, 0.02, 24, 12);
    CutMesh cut(grid(1));
    EmbeddedSurface surface(cut, ring);
    cut.cut(CutSurface::plane({0.5, 0.5, 0.5}, {0, 0, 1}));
    surface.update(cut);
    const std::vector<Piece> found = pieces(surface, cut);
    ASSERT_EQ(found.size(), 2U);
    // Between regular polygons of 24 corners.
    const double annulus = 12 * (0.08 * 0.08 - 0.04 * 0.04) * std::sin(std::numbers::pi / 12);
    for (const Piece& piece : found) {
        EXPECT_NEAR(piece.wall, annulus, lost);
        EXPECT_NEAR(piece.volume, enclosed(ring) / 2, lost);
    }
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
        if (where == 0.5) continue;  // nodes in the plane are on no side
        // Opened by 2 mm where all copies are two, and less near the front: - int u . n over the walls is what lies
        // between them, as their normals point into the opening.
        std::vector<Point> positions = cut.rest_positions();
        for (std::size_t copy = 0; copy < positions.size(); ++copy) {
            const std::int32_t node = cut.node_of_copy()[copy];
            if (cut.copies_of_node(node).size() < 2) continue;
            const bool is_first = static_cast<std::int32_t>(copy) == node;  // which holds the node
            positions[copy][0] += (positions[copy][0] < where) == is_first ? -1e-3 : 1e-3;
        }
        std::vector<Point> places(surface.points().size());
        place(surface.copies(), surface.weights(), positions, places);
        double between = 0;
        for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
            if (surface.is_wall()[t] == 0) continue;
            const auto& [a, b, c] = surface.triangles()[t];
            const auto x = surface.at_rest();
            const Point &p = x[static_cast<std::size_t>(a)], &q = x[static_cast<std::size_t>(b)],
                        &r = x[static_cast<std::size_t>(c)];
            const double normal = ((q[1] - p[1]) * (r[2] - p[2]) - (q[2] - p[2]) * (r[1] - p[1])) / 2;  // along x
            for (const std::int32_t v : {a, b, c}) {
                const auto n = static_cast<std::size_t>(v);
                between -= (places[n][0] - x[n][0]) / 3 * normal;
            }
        }
        EXPECT_GT(between, 0.6 * 2e-3 * found[0].wall / 2);
        EXPECT_LT(between, 2e-3 * found[0].wall / 2);
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

/// Cuts of all kinds; every third sequence along the grid, every third nearly along the last cut, by 0.1 to 1e-14.
class RandomCuts {
  public:
    explicit RandomCuts(unsigned seed) : random_(seed), kind_(seed % 3) {}

    CutSurface next() {
        Point point{near(), near(), near()}, normal{any(), any(), any()}, inward{any(), any(), any()};
        if (kind_ == 1) {
            normal = {};
            normal[random_() % 3] = 1;
        }
        if (kind_ == 2 && has_last_ && random_() % 2 == 0) {
            const double by = std::pow(10.0, -1.0 - static_cast<double>(random_() % 14));
            for (std::size_t axis = 0; axis < 3; ++axis) {
                point[axis] = last_[0][axis] + by * any();
                normal[axis] = last_[1][axis] + (random_() % 2 == 0 ? by * any() : 0);
            }
        }
        last_ = {point, normal};
        has_last_ = true;
        switch (random_() % 5) {
            case 0:
                return CutSurface::plane(point, normal);
            case 1:
                return CutSurface::half_plane(point, normal, inward);
            case 2:
                return CutSurface::parallelogram(point, normal, inward);
            case 3: {
                std::vector<std::array<Point, 2>> places;
                for (int k = 0; k < 4; ++k) {
                    places.push_back({point, Point{point[0] + normal[0], point[1] + normal[1], point[2] + normal[2]}});
                    for (std::size_t axis = 0; axis < 3; ++axis) point[axis] += 0.2 * (inward[axis] + 0.3 * any());
                }
                return CutSurface::swept(places);
            }
            default:
                return CutSurface::level_set([point](const Point& x) {
                    return std::hypot(x[0] - point[0], x[1] - point[1], x[2] - point[2]) - 0.21;
                });
        }
    }

  private:
    double any() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
    double near() { return kind_ == 1 ? 0.2 * static_cast<double>(random_() % 6) : 0.5 + 0.25 * any(); }

    std::mt19937 random_;
    unsigned kind_;
    std::array<Point, 2> last_{};
    bool has_last_ = false;
};

TEST(EmbeddedSurface, RandomCutsLeaveClosedPieces) {
    for (unsigned sequence = 0; sequence < 24; ++sequence) {
        SCOPED_TRACE(sequence);
        const TriangleMesh shapes[] = {sphere({0.5, 0.5, 0.5}, 0.4, 2), torus({0.5, 0.5, 0.5}, 0.28, 0.12, 16, 8),
                                       cuboid({0.2, 0.2, 0.2}, {0.6, 0.6, 0.6}), sphere({0.5, 0.5, 0.5}, 0.4, 1)};
        const TriangleMesh& shape = shapes[sequence % 4];
        const Split split = sequence % 2 == 0 ? Split::five : Split::six;
        CutMesh cut(sequence % 5 < 2 ? around(shape, {.cell_size = 0.27, .split = split}) : grid(5, split));
        EmbeddedSurface surface(cut, shape);
        RandomCuts cuts(sequence);
        for (int k = 0; k < 4; ++k) {
            // Every fourth sequence where the body is bent.
            std::vector<Point> positions;
            if (sequence % 4 == 3) {
                positions = cut.rest_positions();
                for (Point& x : positions) x[2] += 0.1 * std::sin(5 * x[0]) * x[1];
            }
            try {
                cut.cut(cuts.next(), k % 2 == 0 ? FrontTreatment::retract : FrontTreatment::extend, positions);
            } catch (const Error&) {
                continue;  // an inward direction along the normal
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
