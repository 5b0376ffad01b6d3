#include "lancet/mesh/tet_mesh.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/inspect.hpp"

namespace {

using lancet::Error;
using lancet::mesh::inspect;
using lancet::mesh::Point;
using lancet::mesh::Shape;
using lancet::mesh::shape;
using lancet::mesh::TetMesh;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

/// Two tetrahedra on a common face.
TetMesh::Definition pair() {
    return {.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}},
            .tetrahedra = {{0, 1, 2, 3}, {1, 2, 3, 4}},
            .regions = {3, 7},
            .node_sets = {{"fixed", {2, 0, 2}}},
            .region_names = {{3, "skin"}}};
}

std::string error_of(TetMesh::Definition definition) {
    try {
        const TetMesh mesh(std::move(definition));
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

TEST(TetMesh, KeepsWhatItIsMadeOf) {
    const TetMesh mesh(pair());
    EXPECT_EQ(mesh.nodes().size(), 5U);
    EXPECT_THAT(mesh.regions(), ElementsAre(3, 7));
    EXPECT_THAT(mesh.node_set("fixed"), ElementsAre(0, 2));
    EXPECT_EQ(mesh.region_names().at(3), "skin");
    EXPECT_DOUBLE_EQ(mesh.volume(0), 1.0 / 6);
    EXPECT_DOUBLE_EQ(mesh.volume(1), 1.0 / 3);
    EXPECT_DOUBLE_EQ(mesh.volume(), 0.5);
    EXPECT_EQ(mesh.bounds()[1], (Point{1, 1, 1}));
    EXPECT_THROW(mesh.node_set("free"), Error);
}

TEST(TetMesh, CanBeEmpty) {
    EXPECT_TRUE(TetMesh().nodes().empty());
    EXPECT_EQ(TetMesh(TetMesh::Definition{}).volume(), 0.0);
    EXPECT_EQ(TetMesh().bounds()[0], (Point{0, 0, 0}));
}

TEST(TetMesh, PutsElementsWithoutRegionsIntoRegionZero) {
    auto definition = pair();
    definition.regions.clear();
    EXPECT_THAT(TetMesh(definition).regions(), ElementsAre(0, 0));
}

TEST(TetMesh, NamesEachKindOfFault) {
    auto definition = pair();
    definition.tetrahedra[1][2] = 5;
    EXPECT_THAT(error_of(definition), AllOf(HasSubstr("1 of 2 elements with a node number out of range"),
                                            HasSubstr("element 1 with nodes 1 2 5 4")));
    definition = pair();
    definition.tetrahedra[1][2] = -1;
    EXPECT_THAT(error_of(definition), HasSubstr("out of range"));

    definition = pair();
    definition.tetrahedra[1] = {1, 2, 4, 2};
    EXPECT_THAT(error_of(definition), HasSubstr("1 of 2 elements with a repeated node"));

    definition = pair();
    std::swap(definition.tetrahedra[0][0], definition.tetrahedra[0][1]);
    std::swap(definition.tetrahedra[1][0], definition.tetrahedra[1][1]);
    EXPECT_THAT(error_of(definition),
                AllOf(HasSubstr("2 of 2 elements inverted"), HasSubstr("worst volume -0.333333 at element 1")));

    definition = pair();
    definition.nodes[3] = {0.3, 0.4, 0};
    EXPECT_THAT(error_of(definition), HasSubstr("1 of 2 elements flat"));

    definition = pair();
    definition.tetrahedra.push_back({2, 3, 1, 4});
    definition.regions.push_back(0);
    EXPECT_THAT(error_of(definition), HasSubstr("1 of 3 elements repeat an earlier one (first: element 2"));

    definition = pair();
    definition.nodes.push_back({5, 5, 5});
    EXPECT_THAT(error_of(definition), HasSubstr("1 of 6 nodes not used by any element (first: node 5)"));

    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
        definition = pair();
        definition.nodes[4][1] = bad;
        EXPECT_THAT(error_of(definition), HasSubstr("1 of 5 nodes with a coordinate that is not finite"));
    }

    definition = pair();
    definition.regions.pop_back();
    EXPECT_THAT(error_of(definition), HasSubstr("1 region numbers for 2 elements"));

    definition = pair();
    definition.node_sets["top"] = {1, 9};
    EXPECT_THAT(error_of(definition), HasSubstr("node set 'top' names node 9 of 5"));
}

TEST(TetMesh, NamesSeveralFaultsInOneLine) {
    auto definition = pair();
    definition.tetrahedra[1][2] = 77;
    definition.nodes[4][1] = std::nan("");
    const std::string error = error_of(definition);
    EXPECT_THAT(error, AllOf(HasSubstr("not finite"), HasSubstr("out of range")));
    EXPECT_EQ(error.find('\n'), std::string::npos);
}

TEST(Shape, DoesNotDependOnTheScale) {
    const auto scaled = [](double s, double height) {
        return shape({0, 0, 0}, {s, 0, 0}, {0, s, 0}, {s / 3, s / 3, s * height});
    };
    for (const double s : {1e-90, 1e-30, 1e-6, 1.0, 1e6, 1e30, 1e90}) {
        EXPECT_EQ(scaled(s, 1), Shape::positive) << s;
        EXPECT_EQ(scaled(s, -1), Shape::inverted) << s;
        EXPECT_EQ(scaled(s, 1e-12), Shape::positive) << s;
        EXPECT_EQ(scaled(s, 1e-17), Shape::flat) << s;
        EXPECT_EQ(scaled(s, 0), Shape::flat) << s;
    }
    // The volume itself is no longer a normal double number.
    for (const double s : {1e-300, 1e-110, 1e110, 1e300}) EXPECT_EQ(scaled(s, 1), Shape::flat) << s;
}

TEST(Shape, ElementsWhoseSignRoundingChoseAreFlat) {
    // Four points of a slanted plane, rounded to double numbers far from the origin.
    int flat = 0;
    for (int n = 1; n <= 100; ++n) {
        const double u = 0.01 * n;
        const auto on_plane = [&](double x, double y) { return Point{x, y, 1000 + x / 3 + y / 7}; };
        const Shape kind = shape(on_plane(0, 0), on_plane(1, u), on_plane(u, 1), on_plane(u / 3, u * u));
        flat += kind == Shape::flat ? 1 : 0;
    }
    EXPECT_EQ(flat, 100);
}

TEST(Inspect, ListsEveryPlace) {
    auto definition = pair();
    for (int extra = 0; extra < 3; ++extra) {
        definition.tetrahedra.push_back({0, 1, 2, 3});
        definition.nodes.push_back({9, 9, 9});
    }
    definition.regions.clear();
    const auto found = inspect(definition);
    EXPECT_THAT(found.duplicate_elements, ElementsAre(2, 3, 4));
    EXPECT_THAT(found.isolated_nodes, ElementsAre(5, 6, 7));
    EXPECT_FALSE(found.clean());
}

}  // namespace
