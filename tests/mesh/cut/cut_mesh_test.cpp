// What a cut separates and what still hangs together: volumes, parts and copies, on meshes whose answers are known.
#include "lancet/mesh/cut/cut_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/components.hpp"
#include "lancet/mesh/cut/element_cells.hpp"
#include "lancet/mesh/generate/box.hpp"

namespace lancet::test {
namespace {

using mesh::CutMesh;
using mesh::CutSurface;
using mesh::Point;

constexpr double unit = 0x1p-53;

CutMesh cube(int cells, mesh::Split split = mesh::Split::five) {
    return CutMesh(mesh::box({.cells = {cells, cells, cells}, .split = split}));
}

/// The pieces of a body: volume and first moment of each component.
struct Piece {
    double volume = 0;
    Point moment{};
};
std::vector<Piece> pieces(const CutMesh& cut) {
    const auto components = mesh::components(cut.node_of_copy().size(), cut.parts());
    std::vector<Piece> found(static_cast<std::size_t>(components.count));
    for (std::size_t part = 0; part < cut.parts().size(); ++part) {
        const std::int32_t element = cut.element_of_part()[part];
        const auto moments = cut.moments(static_cast<std::int32_t>(part));
        Piece& piece = found[static_cast<std::size_t>(components.of_element[part])];
        piece.volume += moments.fraction * cut.mesh().volume(element);
        for (std::size_t corner = 0; corner < 4; ++corner) {
            const Point& node = cut.mesh().nodes()[static_cast<std::size_t>(cut.mesh().tetrahedra()[element][corner])];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                piece.moment[axis] += moments.first[corner] * cut.mesh().volume(element) * node[axis];
            }
        }
    }
    return found;
}

/// What holds after any cuts.
void expect_consistent(const CutMesh& cut) {
    const std::size_t elements = cut.mesh().tetrahedra().size();
    std::vector<double> fraction(elements, 0.0);
    for (std::size_t part = 0; part < cut.parts().size(); ++part) {
        const auto number = static_cast<std::int32_t>(part);
        const std::int32_t element = cut.element_of_part()[part];
        const auto moments = cut.moments(number);
        EXPECT_GT(moments.fraction, 0) << "part " << part;
        fraction[static_cast<std::size_t>(element)] += moments.fraction;
        for (std::size_t corner = 0; corner < 4; ++corner) {
            const auto copy = static_cast<std::size_t>(cut.parts()[part][corner]);
            ASSERT_LT(copy, cut.node_of_copy().size());
            EXPECT_EQ(cut.node_of_copy()[copy], cut.mesh().tetrahedra()[static_cast<std::size_t>(element)][corner]);
        }
        const std::int32_t parent = cut.parent_of_part()[part];
        EXPECT_EQ(parent < 0, part < elements);
        if (parent >= 0) {
            EXPECT_EQ(cut.element_of_part()[static_cast<std::size_t>(parent)], element);
        }
    }
    // The parts are sums over cells, of some tens of roundings each.
    for (std::size_t e = 0; e < elements; ++e) EXPECT_NEAR(fraction[e], 1, 256 * unit) << "element " << e;
    std::vector<int> uses(cut.node_of_copy().size(), 0);
    for (const auto& corners : cut.parts()) {
        for (const std::int32_t copy : corners) ++uses[static_cast<std::size_t>(copy)];
    }
    EXPECT_TRUE(std::ranges::all_of(uses, [](int count) { return count > 0; })) << "a copy without a part";
}

TEST(CutMesh, APlaneMakesTwoPiecesOfTheRightVolumeAndCentre) {
    for (const mesh::Split split : {mesh::Split::five, mesh::Split::six}) {
        CutMesh cut = cube(4, split);
        const auto report = cut.cut(CutSurface::plane({0.3, 0, 0}, {1, 0, 0}));
        EXPECT_GT(report.divided_elements, 0);
        EXPECT_EQ(report.new_parts, report.divided_elements);
        // One layer of cells is cut: the copies of its two layers of nodes.
        EXPECT_EQ(report.new_copies, 2 * 25);
        expect_consistent(cut);
        const auto found = pieces(cut);
        ASSERT_EQ(found.size(), 2U);
        EXPECT_NEAR(found[0].volume, 0.3, 1e-14);
        EXPECT_NEAR(found[1].volume, 0.7, 1e-14);
        EXPECT_NEAR(found[0].moment[0], 0.3 * 0.15, 1e-14);
        EXPECT_NEAR(found[1].moment[0], 0.7 * 0.65, 1e-14);
        EXPECT_NEAR(found[1].moment[1], 0.7 * 0.5, 1e-14);
    }
}

TEST(CutMesh, APlaneAlongFacesDividesNothingAndDoublesItsNodes) {
    CutMesh cut = cube(4);
    const auto report = cut.cut(CutSurface::plane({0.5, 0.1, 0.7}, {-3, 0, 0}));
    EXPECT_EQ(report.divided_elements, 0);
    EXPECT_EQ(report.new_parts, 0);
    EXPECT_EQ(report.new_copies, 25);
    expect_consistent(cut);
    const auto found = pieces(cut);
    ASSERT_EQ(found.size(), 2U);
    EXPECT_NEAR(found[0].volume, 0.5, 1e-15);
}

// The plane holds nodes and diagonals of faces, and crosses elements elsewhere.
TEST(CutMesh, ADiagonalPlaneThroughNodesAndEdges) {
    for (const mesh::Split split : {mesh::Split::five, mesh::Split::six}) {
        for (const Point& normal :
             {Point{1, -1, 0}, Point{1, 1, 0}, Point{1, 1, 1}, Point{2, -1, 0}, Point{1, 2, -3}}) {
            CutMesh cut = cube(4, split);
            cut.cut(CutSurface::plane({0.5, 0.5, 0.5}, normal));
            expect_consistent(cut);
            const auto found = pieces(cut);
            ASSERT_EQ(found.size(), 2U);
            EXPECT_NEAR(found[0].volume, 0.5, 1e-14);
            EXPECT_NEAR(found[1].volume, 0.5, 1e-14);
        }
    }
}

TEST(CutMesh, OneUnitInTheLastPlaceBesideTheFacesMakesSlivers) {
    for (const double x : {std::nextafter(0.5, 0.0), std::nextafter(0.5, 1.0)}) {
        CutMesh cut = cube(4);
        cut.cut(CutSurface::plane({x, 0, 0}, {1, 0, 0}));
        expect_consistent(cut);
        double smallest = 1;
        for (std::size_t part = 0; part < cut.parts().size(); ++part) {
            smallest = std::min(smallest, cut.moments(static_cast<std::int32_t>(part)).fraction);
        }
        // Next to a corner the piece is the cube of one unit over the size of a cell: to full relative precision.
        const double thickness = std::abs(x - 0.5) / 0.25;
        EXPECT_NEAR(smallest / (thickness * thickness * thickness), 1, 1e-12);
        EXPECT_EQ(pieces(cut).size(), 2U);
    }
}

// Between planes that nearly coincide the coordinates of the corners cancel; their volumes do not.
TEST(CutMesh, ALayerOfOneUnitInTheLastPlaceHasItsVolume) {
    for (const double x : {0.3, 0.41}) {
        for (const double normal : {1.0, -3.0}) {
            CutMesh cut = cube(4);
            const double next = std::nextafter(x, 1.0);
            cut.cut(CutSurface::plane({x, 0.2, 0.7}, {normal, 0, 0}));
            cut.cut(CutSurface::plane({next, 0.4, 0.1}, {1, 0, 0}));
            expect_consistent(cut);
            const auto found = pieces(cut);
            ASSERT_EQ(found.size(), 3U);
            double thinnest = 1;
            for (const Piece& piece : found) thinnest = std::min(thinnest, piece.volume);
            EXPECT_NEAR(thinnest / (next - x), 1, 1e-8);
        }
    }
}

TEST(CutMesh, CrossingPlanesMakeQuartersAndEighths) {
    for (const double where : {0.5, 0.4375, 0.41}) {
        CutMesh cut = cube(4);
        cut.cut(CutSurface::plane({where, 0, 0}, {1, 0, 0}));
        cut.cut(CutSurface::plane({0, where, 0}, {0, 1, 0}));
        EXPECT_EQ(pieces(cut).size(), 4U);
        cut.cut(CutSurface::plane({0, 0, where}, {0, 0, 1}));
        expect_consistent(cut);
        const auto found = pieces(cut);
        ASSERT_EQ(found.size(), 8U);
        EXPECT_NEAR(found[0].volume, where * where * where, 1e-14);
    }
}

TEST(CutMesh, ACutThatEndsInsideLeavesOnePiece) {
    CutMesh cut = cube(4);
    const auto report = cut.cut(CutSurface::half_plane({0.6, 0, 0.3}, {0, 0, 1}, {-1, 0, 0}));
    expect_consistent(cut);
    EXPECT_EQ(pieces(cut).size(), 1U);
    // The front at 0.6 lies in the third cell: elements of two cells are cut right through, and no node beyond 0.5 has
    // two copies.
    const auto copies_at = [](const CutMesh& mesh, double x) {
        std::size_t copies = 0;
        for (const std::int32_t node : mesh.node_of_copy()) {
            copies += mesh.mesh().nodes()[static_cast<std::size_t>(node)][0] == x ? 1 : 0;
        }
        return copies - 25;
    };
    EXPECT_EQ(copies_at(cut, 0), 10U);
    EXPECT_EQ(copies_at(cut, 0.25), 10U);
    EXPECT_EQ(copies_at(cut, 0.75), 0U);
    EXPECT_EQ(copies_at(cut, 1), 0U);
    EXPECT_LT(report.new_copies, 30);

    CutMesh longer = cube(4);
    const auto extended =
        longer.cut(CutSurface::half_plane({0.6, 0, 0.3}, {0, 0, 1}, {-1, 0, 0}), mesh::FrontTreatment::extend);
    expect_consistent(longer);
    EXPECT_EQ(pieces(longer).size(), 1U);
    EXPECT_EQ(copies_at(longer, 0), 10U);
    EXPECT_EQ(copies_at(longer, 0.25), 10U);
    EXPECT_EQ(copies_at(longer, 0.75), 0U);
    EXPECT_EQ(copies_at(longer, 1), 0U);
    EXPECT_GT(extended.new_copies, report.new_copies);
}

TEST(CutMesh, TheFrontOneUnitToEitherSideOfTheFaces) {
    const auto copies_of = [](double front) {
        CutMesh cut = cube(4);
        const auto report = cut.cut(CutSurface::half_plane({front, 0, 0.3}, {0, 0, 1}, {-1, 0, 0}));
        expect_consistent(cut);
        return report.new_copies;
    };
    // On the faces and behind them the elements ahead are crossed in part or not at all; before them so are those
    // behind.
    EXPECT_EQ(copies_of(std::nextafter(0.5, 1.0)), copies_of(0.5));
    EXPECT_LT(copies_of(std::nextafter(0.5, 0.0)), copies_of(0.5));
}

/// A wavy sheet of triangles over [-0.1, 1.1]^2.
CutSurface wavy_sheet(int cells, double height, double amplitude) {
    std::vector<Point> vertices;
    std::vector<mesh::Triangle> triangles;
    for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) {
            const double x = -0.1 + 1.2 * i / cells, y = -0.1 + 1.2 * j / cells;
            vertices.push_back({x, y, height + amplitude * std::sin(5 * x) * std::cos(4 * y)});
            if (i == cells || j == cells) continue;
            const int a = i + (cells + 1) * j, b = a + 1, c = a + cells + 1, d = c + 1;
            triangles.push_back({a, b, d});
            triangles.push_back({a, d, c});
        }
    }
    return CutSurface::triangulated(vertices, triangles);
}

// Facets that share edges leave no gap through which the two sides could hang together.
TEST(CutMesh, ASheetOfTrianglesSeparatesCompletely) {
    for (const int cells : {1, 3, 10, 23}) {
        CutMesh cut = cube(4);
        cut.cut(wavy_sheet(cells, 0.47, 0.1));
        expect_consistent(cut);
        const auto found = pieces(cut);
        EXPECT_EQ(found.size(), 2U) << cells << " cells";
        double volume = 0;
        for (const Piece& piece : found) volume += piece.volume;
        EXPECT_NEAR(volume, 1, 1e-14);
    }
}

TEST(CutMesh, ASweptBladeCutsTheSameInStepsAndAtOnce) {
    std::vector<std::array<Point, 2>> places;
    for (int k = 0; k <= 12; ++k) {
        const double x = -0.05 + 0.85 * k / 12;
        places.push_back(
            {Point{x, -0.1, 0.4 + 0.1 * std::sin(3 * x)}, Point{x + 0.02, 1.1, 0.45 + 0.1 * std::sin(4 * x)}});
    }
    CutMesh once = cube(4), steps = cube(4);
    once.cut(CutSurface::swept(places));
    for (std::size_t k = 1; k < places.size(); ++k) {
        const std::size_t copies = steps.node_of_copy().size();
        std::vector<mesh::Tetrahedron> before(steps.parts().begin(), steps.parts().end());
        steps.cut(CutSurface::swept(std::span(places).subspan(k - 1, 2)));
        expect_consistent(steps);
        // Nothing that was apart comes together, and old numbers stay.
        EXPECT_GE(steps.node_of_copy().size(), copies);
        for (std::size_t part = 0; part < before.size(); ++part) {
            for (std::size_t corner = 0; corner < 4; ++corner) {
                std::int32_t copy = steps.parts()[part][corner];
                while (copy >= static_cast<std::int32_t>(copies)) copy = steps.parent_of_copy()[copy];
                EXPECT_EQ(copy, before[part][corner]);
            }
        }
    }
    EXPECT_EQ(once.node_of_copy().size(), steps.node_of_copy().size());
    EXPECT_EQ(once.parts().size(), steps.parts().size());
    const auto fractions = [](const CutMesh& cut) {
        std::map<std::int32_t, std::multiset<double>> of_element;
        for (std::size_t part = 0; part < cut.parts().size(); ++part) {
            of_element[cut.element_of_part()[part]].insert(cut.moments(static_cast<std::int32_t>(part)).fraction);
        }
        return of_element;
    };
    const auto a = fractions(once), b = fractions(steps);
    for (const auto& [element, values] : a) {
        const auto& others = b.at(element);
        ASSERT_EQ(values.size(), others.size());
        for (auto p = values.begin(), q = others.begin(); p != values.end(); ++p, ++q) EXPECT_NEAR(*p, *q, 1e-12);
    }
}

// A stroke divides what it reaches: what earlier ones left in the same element is not divided by planes of its facets.
TEST(CutMesh, ManyStrokesInOneElementMakeAFewCellsEach) {
    constexpr int strokes = 40;
    CutMesh cut = cube(1);
    const auto sway = [](double x) { return 0.01 * std::sin(11 * x); };
    for (int k = 0; k < strokes; ++k) {
        const double from = 0.9 - 0.7 * k / strokes, to = 0.9 - 0.7 * (k + 1) / strokes;
        std::vector<Point> vertices;
        for (const double y : {from, to}) {
            for (int i = 0; i <= 3; ++i) {
                const double z = 0.35 + 0.1 * i;
                vertices.push_back({0.5 + sway(z + 2 * y), y, z + sway(3 * y)});
            }
        }
        std::vector<mesh::Triangle> triangles;
        for (int i = 0; i < 3; ++i) {
            triangles.push_back({i, i + 1, i + 5});
            triangles.push_back({i, i + 5, i + 4});
        }
        EXPECT_EQ(cut.cut(CutSurface::triangulated(vertices, triangles)).new_parts, 0);
    }
    expect_consistent(cut);
    EXPECT_EQ(pieces(cut).size(), 1U);
    std::size_t cells = 0;
    for (const std::int32_t element : cut.touched_elements()) cells += cut.cells(element)->cells();
    EXPECT_LT(cells, 12U * 6 * strokes) << "of 6 facets a stroke";
}

// Whole planes: a part is exactly the places of its element on the same sides of all of them.
TEST(CutMesh, RandomPlanesAgreeWithTheSidesOfRandomPlaces) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> normal;
    for (int trial = 0; trial < 20; ++trial) {
        CutMesh cut = cube(2, trial % 2 == 0 ? mesh::Split::five : mesh::Split::six);
        std::vector<std::pair<Point, Point>> planes;
        const int count = 1 + trial % 5;
        for (int k = 0; k < count; ++k) {
            // Every other plane holds three nodes of the lattice.
            const auto lattice = [&] { return std::round(4 * uniform(random)) / 4; };
            planes.push_back(k % 2 == 0
                                 ? std::pair(Point{uniform(random), uniform(random), uniform(random)},
                                             Point{normal(random), normal(random), normal(random)})
                                 : std::pair(Point{lattice(), lattice(), lattice()},
                                             Point{std::round(3 * normal(random)), 1, std::round(normal(random))}));
            cut.cut(CutSurface::plane(planes.back().first, planes.back().second));
        }
        expect_consistent(cut);
        std::map<std::int32_t, std::vector<bool>> sides_of_part;
        std::map<std::pair<std::int32_t, std::vector<bool>>, std::int32_t> part_of_sides;
        for (int sample = 0; sample < 4000; ++sample) {
            const auto element =
                static_cast<std::int32_t>(uniform(random) * static_cast<double>(cut.mesh().tetrahedra().size()));
            mesh::Barycentric place{-std::log(uniform(random)), -std::log(uniform(random)), -std::log(uniform(random)),
                                    -std::log(uniform(random))};
            const double sum = place[0] + place[1] + place[2] + place[3];
            Point x{};
            for (std::size_t corner = 0; corner < 4; ++corner) {
                place[corner] /= sum;
                const Point& node =
                    cut.mesh().nodes()[static_cast<std::size_t>(cut.mesh().tetrahedra()[element][corner])];
                for (std::size_t axis = 0; axis < 3; ++axis) x[axis] += place[corner] * node[axis];
            }
            std::vector<bool> sides;
            bool is_near = false;
            for (const auto& [point, direction] : planes) {
                double value = 0;
                for (std::size_t axis = 0; axis < 3; ++axis) value += direction[axis] * (x[axis] - point[axis]);
                is_near = is_near || std::abs(value) < 1e-12;
                sides.push_back(value > 0);
            }
            if (is_near) continue;
            const std::int32_t part = cut.material_point(element, place).part;
            EXPECT_EQ(cut.element_of_part()[static_cast<std::size_t>(part)], element);
            const auto [known, is_first] = sides_of_part.try_emplace(part, sides);
            EXPECT_EQ(known->second, sides);
            const auto [other, is_new] = part_of_sides.try_emplace({element, sides}, part);
            EXPECT_EQ(other->second, part);
        }
    }
}

TEST(CutMesh, TheOrderOfCutsDoesNotMatter) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(0.2, 0.8), spread(-0.6, 0.6);
    for (int trial = 0; trial < 10; ++trial) {
        std::vector<CutSurface> surfaces;
        for (int k = 0; k < 4; ++k) {
            surfaces.push_back(CutSurface::parallelogram({uniform(random), uniform(random), uniform(random)},
                                                         {spread(random), spread(random), spread(random)},
                                                         {spread(random), spread(random), spread(random)}));
        }
        CutMesh forward = cube(3), backward = cube(3);
        for (std::size_t k = 0; k < 4; ++k) {
            forward.cut(surfaces[k]);
            backward.cut(surfaces[3 - k]);
        }
        expect_consistent(forward);
        expect_consistent(backward);
        EXPECT_EQ(forward.parts().size(), backward.parts().size());
        EXPECT_EQ(forward.node_of_copy().size(), backward.node_of_copy().size());
    }
}

TEST(CutMesh, ACutRepeatedChangesNothing) {
    CutMesh cut = cube(4);
    const auto sheet = wavy_sheet(7, 0.5, 0.07);
    cut.cut(sheet);
    const auto again = cut.cut(sheet);
    EXPECT_EQ(again.new_parts, 0);
    EXPECT_EQ(again.new_copies, 0);
    expect_consistent(cut);
}

// A node at the origin, moved by one unit in the last place, is 4.9e-324 away: products of such values are below every
// double, and yet have a sign.
TEST(CutMesh, PlanesASubnormalNumberBesideANodeAreOnTheirSideOfIt) {
    for (const double beside : {0x1p-1074, -0x1p-1074, 0x1p-1040, 0x1p-1022, 0x1p-400}) {
        CutMesh cut(mesh::box({.cells = {2, 2, 2}, .split = mesh::Split::six, .origin = {-0.5, -0.5, -0.5}}));
        cut.cut(CutSurface::plane({beside, 0, 0}, {1, 0, 0}));
        cut.cut(CutSurface::plane({0, beside, 0}, {0.5, 1, 0}));
        cut.cut(CutSurface::plane({0, 0, beside}, {0.25, 0.5, 1}));
        cut.cut(CutSurface::plane({0, 0, -beside}, {1, 1, 1}));
        cut.cut(CutSurface::plane({beside, beside, beside}, {-1, 0.5, 0.25}));
        std::vector<double> fractions(cut.mesh().tetrahedra().size(), 0.0);
        for (std::size_t part = 0; part < cut.parts().size(); ++part) {
            const double fraction = cut.moments(static_cast<std::int32_t>(part)).fraction;
            EXPECT_GE(fraction, 0) << beside;  // zero where the volume is below every double
            fractions[static_cast<std::size_t>(cut.element_of_part()[part])] += fraction;
        }
        for (const double sum : fractions) EXPECT_NEAR(sum, 1, 0x1p-45) << beside;
    }
}

TEST(CutMesh, ALevelSetIsTakenAsLinearBetweenNodes) {
    CutMesh cut = cube(12);
    cut.cut(CutSurface::level_set([](const Point& x) { return std::hypot(x[0] - 0.5, x[1] - 0.5, x[2] - 0.5) - 0.3; }));
    expect_consistent(cut);
    const auto found = pieces(cut);
    ASSERT_EQ(found.size(), 2U);
    const double ball = 4.0 / 3.0 * 3.141592653589793 * 0.027;
    const double smaller = std::min(found[0].volume, found[1].volume);
    EXPECT_NEAR(smaller, ball, 0.05 * ball);
    EXPECT_LT(smaller, ball);  // chords of a convex body
}

TEST(CutMesh, ACutIsTakenWhereTheBodyHasMoved) {
    // The body is turned by 90 degrees about z and moved: x' = 2 - y, y' = x.
    CutMesh cut = cube(4), turned = cube(4);
    cut.cut(CutSurface::plane({0.31, 0, 0}, {1, 0, 0}));
    std::vector<Point> positions = turned.rest_positions();
    for (Point& x : positions) x = {2 - x[1], x[0], x[2]};
    turned.cut(CutSurface::plane({0, 0.31, 0}, {0, 1, 0}), mesh::FrontTreatment::retract, positions);
    EXPECT_EQ(cut.parts().size(), turned.parts().size());
    EXPECT_TRUE(std::ranges::equal(cut.parts(), turned.parts()));
    // Pulled apart by then, the two pieces are cut by a plane that meets only one of them.
    positions = turned.rest_positions();
    const auto components = mesh::components(turned.node_of_copy().size(), turned.parts());
    for (std::size_t copy = 0; copy < positions.size(); ++copy) positions[copy][2] += 5.0 * components.of_node[copy];
    turned.cut(CutSurface::plane({0, 0, 5.4}, {0, 0, 1}), mesh::FrontTreatment::retract, positions);
    expect_consistent(turned);
    EXPECT_EQ(pieces(turned).size(), 3U);
}

TEST(CutMesh, BadSurfacesAndPositionsAreRefused) {
    EXPECT_THROW(CutSurface::plane({0, 0, 0}, {0, 0, 0}), Error);
    EXPECT_THROW(CutSurface::plane({NAN, 0, 0}, {0, 0, 1}), Error);
    EXPECT_THROW(CutSurface::half_plane({0, 0, 0}, {0, 0, 1}, {0, 0, 2}), Error);
    EXPECT_THROW(CutSurface::parallelogram({0, 0, 0}, {1, 0, 0}, {2, 0, 0}), Error);
    EXPECT_THROW(CutSurface::swept(std::vector<std::array<Point, 2>>{{Point{}, Point{1, 0, 0}}}), Error);
    const std::vector<Point> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    const std::vector<mesh::Triangle> flat{{0, 1, 2}}, missing{{0, 1, 3}};
    EXPECT_THROW(CutSurface::triangulated(line, flat), Error);
    EXPECT_THROW(CutSurface::triangulated(line, missing), Error);
    CutMesh cut = cube(1);
    EXPECT_THROW(cut.cut(CutSurface::plane({0.5, 0, 0}, {1, 0, 0}), mesh::FrontTreatment::retract, line), Error);
}

TEST(CutMesh, PlacesAndFunctionsThatAreNotFiniteAreRefusedAndLeaveNoTrace) {
    CutMesh cut = cube(2);
    cut.cut(CutSurface::plane({0.4, 0, 0}, {1, 0, 0}));
    const std::vector<mesh::Tetrahedron> before(cut.parts().begin(), cut.parts().end());
    for (const double bad : {static_cast<double>(NAN), HUGE_VAL, -HUGE_VAL}) {
        // Bad at the last corner alone: by then the other elements have been found.
        const auto function = [&](const Point& x) { return x[0] + x[1] + x[2] > 2.9 ? bad : x[2] - 0.3; };
        EXPECT_THROW(cut.cut(CutSurface::level_set(function)), Error);
        std::vector<Point> positions = cut.rest_positions();
        positions.back()[1] = bad;
        EXPECT_THROW(cut.cut(CutSurface::plane({0, 0, 0.3}, {0, 0, 1}), mesh::FrontTreatment::retract, positions),
                     Error);
        EXPECT_TRUE(std::ranges::equal(cut.parts(), before));
        expect_consistent(cut);
    }
    EXPECT_GT(cut.cut(CutSurface::plane({0, 0, 0.3}, {0, 0, 1})).new_parts, 0);
}

}  // namespace
}  // namespace lancet::test
