#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/boundary.hpp"
#include "lancet/mesh/components.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/mesh/node_graph.hpp"
#include "lancet/mesh/order.hpp"

namespace {

using lancet::Error;
using lancet::mesh::Boundary;
using lancet::mesh::Ordering;
using lancet::mesh::OrderingKind;
using lancet::mesh::Point;
using lancet::mesh::Split;
using lancet::mesh::TetMesh;
using lancet::mesh::Tetrahedron;
using lancet::mesh::Triangle;
using testing::ElementsAre;

/// Twice the area vector of a triangle.
Point normal(const TetMesh& mesh, const Triangle& t) {
    const auto x = mesh.nodes();
    Point u{};
    Point v{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        u[axis] = x[t[1]][axis] - x[t[0]][axis];
        v[axis] = x[t[2]][axis] - x[t[0]][axis];
    }
    return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

/// A mesh whose numbers are shuffled, with regions and a node set that say where things were.
TetMesh shuffled(const TetMesh& mesh, unsigned seed) {
    std::mt19937 random(seed);
    Ordering ordering;
    const auto shuffle = [&](std::vector<std::int32_t>& numbers, std::vector<std::int32_t>& inverse, std::size_t size) {
        numbers.resize(size);
        std::iota(numbers.begin(), numbers.end(), 0);
        std::shuffle(numbers.begin(), numbers.end(), random);
        inverse.resize(size);
        for (std::size_t n = 0; n < size; ++n) inverse[numbers[n]] = static_cast<std::int32_t>(n);
    };
    shuffle(ordering.node_of_new, ordering.new_of_node, mesh.nodes().size());
    shuffle(ordering.element_of_new, ordering.new_of_element, mesh.tetrahedra().size());
    return lancet::mesh::reordered(mesh, ordering);
}

/// Two boxes that do not touch.
TetMesh two_boxes() {
    auto definition = lancet::mesh::box({.cells = {4, 3, 3}}).definition();
    const auto second = lancet::mesh::box({.cells = {2, 5, 2}, .split = Split::six, .origin = {2, 2, 2}});
    const auto offset = static_cast<std::int32_t>(definition.nodes.size());
    definition.nodes.insert(definition.nodes.end(), second.nodes().begin(), second.nodes().end());
    definition.regions.clear();
    for (Tetrahedron t : second.tetrahedra()) {
        for (std::int32_t& node : t) node += offset;
        definition.tetrahedra.push_back(t);
    }
    for (std::size_t t = 0; t < definition.tetrahedra.size(); ++t) {
        definition.regions.push_back(static_cast<std::int32_t>(t));
    }
    return TetMesh(definition);
}

std::int64_t profile(const TetMesh& mesh) {
    std::int64_t sum = 0;
    for (const Tetrahedron& t : mesh.tetrahedra()) {
        const auto [low, high] = std::minmax_element(t.begin(), t.end());
        sum += *high - *low;
    }
    return sum;
}

TEST(Boundary, OfABoxFacesOutwardAndEnclosesItsVolume) {
    const TetMesh mesh = lancet::mesh::box({.cells = {3, 2, 4}, .size = {3, 2, 4}});
    const Boundary surface = lancet::mesh::boundary(mesh);
    EXPECT_EQ(surface.triangles.size(), 2U * 2U * (6U + 8U + 12U));
    EXPECT_EQ(surface.overused_faces, 0);
    double volume = 0;
    for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
        const Triangle& triangle = surface.triangles[f];
        const Point n = normal(mesh, triangle);
        Point middle{};
        for (const std::int32_t node : triangle) {
            for (std::size_t axis = 0; axis < 3; ++axis) middle[axis] += mesh.nodes()[node][axis] / 3;
        }
        const Point centre{1.5, 1, 2};
        double outward = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            outward += n[axis] * (middle[axis] - centre[axis]);
            volume += n[axis] * middle[axis] / 6;
        }
        EXPECT_GT(outward, 0);
        const Tetrahedron& behind = mesh.tetrahedra()[surface.elements[f]];
        for (const std::int32_t node : triangle) EXPECT_EQ(std::count(behind.begin(), behind.end(), node), 1);
    }
    EXPECT_NEAR(volume, 24, 1e-12);
}

TEST(Boundary, OfOneElementHasItsFourFaces) {
    const TetMesh mesh({.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .tetrahedra = {{0, 1, 2, 3}}});
    EXPECT_THAT(lancet::mesh::boundary(mesh).triangles,
                ElementsAre(Triangle{1, 2, 3}, Triangle{0, 3, 2}, Triangle{0, 1, 3}, Triangle{0, 2, 1}));
    EXPECT_TRUE(lancet::mesh::boundary(TetMesh()).triangles.empty());
}

TEST(Boundary, CountsFacesOfThreeElements) {
    const TetMesh mesh({.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, -1}},
                        .tetrahedra = {{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 2, 1, 5}}});
    EXPECT_EQ(lancet::mesh::boundary(mesh).overused_faces, 1);
}

TEST(Components, AreToldApartAndNumberedByLowestNode) {
    const TetMesh mesh = two_boxes();
    const auto parts = lancet::mesh::components(mesh);
    EXPECT_EQ(parts.count, 2);
    for (std::size_t n = 0; n < mesh.nodes().size(); ++n) EXPECT_EQ(parts.of_node[n], mesh.nodes()[n][0] < 1.5 ? 0 : 1);
    for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t) {
        EXPECT_EQ(parts.of_element[t], parts.of_node[mesh.tetrahedra()[t][0]]);
    }
    EXPECT_EQ(lancet::mesh::components(TetMesh()).count, 0);
    EXPECT_EQ(lancet::mesh::components(shuffled(mesh, 3)).count, 2);
}

TEST(Components, OneSharedNodeConnects) {
    const TetMesh mesh({.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
                        .tetrahedra = {{0, 1, 2, 3}, {0, 5, 4, 6}}});
    EXPECT_EQ(lancet::mesh::components(mesh).count, 1);
}

TEST(NodeGraph, HoldsEachPairOfAnElementBothWays) {
    const TetMesh mesh = two_boxes();
    const auto graph = lancet::mesh::node_graph(mesh);
    EXPECT_EQ(graph.node_count(), mesh.nodes().size());
    for (std::int32_t n = 0; n < static_cast<std::int32_t>(graph.node_count()); ++n) {
        EXPECT_TRUE(std::is_sorted(graph.of(n).begin(), graph.of(n).end()));
        for (const std::int32_t other : graph.of(n)) {
            EXPECT_NE(other, n);
            EXPECT_TRUE(std::binary_search(graph.of(other).begin(), graph.of(other).end(), n));
        }
    }
    for (const Tetrahedron& t : mesh.tetrahedra()) {
        for (const std::int32_t a : t) {
            for (const std::int32_t b : t) {
                EXPECT_EQ(std::binary_search(graph.of(a).begin(), graph.of(a).end(), b), a != b);
            }
        }
    }
}

class OrderKind : public testing::TestWithParam<OrderingKind> {};

TEST_P(OrderKind, IsAPermutationThatCanBeUndone) {
    const TetMesh mesh = shuffled(two_boxes(), 5);
    const Ordering ordering = lancet::mesh::order(mesh, GetParam());
    const TetMesh ordered = lancet::mesh::reordered(mesh, ordering);
    ASSERT_EQ(ordered.nodes().size(), mesh.nodes().size());
    for (std::size_t n = 0; n < mesh.nodes().size(); ++n) {
        EXPECT_EQ(ordered.nodes()[ordering.new_of_node[n]], mesh.nodes()[n]);
        EXPECT_EQ(ordering.node_of_new[ordering.new_of_node[n]], static_cast<std::int32_t>(n));
    }
    for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t) {
        Tetrahedron nodes = mesh.tetrahedra()[t];
        for (std::int32_t& node : nodes) node = ordering.new_of_node[node];
        EXPECT_EQ(ordered.tetrahedra()[ordering.new_of_element[t]], nodes);
        EXPECT_EQ(ordered.regions()[ordering.new_of_element[t]], mesh.regions()[t]);
    }
    for (const auto& [name, members] : mesh.node_sets()) {
        EXPECT_EQ(ordered.node_set(name).size(), members.size());
        for (const std::int32_t node : members) {
            EXPECT_EQ(
                std::count(ordered.node_set(name).begin(), ordered.node_set(name).end(), ordering.new_of_node[node]),
                1);
        }
    }
    const Ordering back{ordering.new_of_node, ordering.node_of_new, ordering.new_of_element, ordering.element_of_new};
    const TetMesh restored = lancet::mesh::reordered(ordered, back);
    EXPECT_TRUE(std::equal(restored.tetrahedra().begin(), restored.tetrahedra().end(), mesh.tetrahedra().begin()));
    EXPECT_TRUE(std::equal(restored.nodes().begin(), restored.nodes().end(), mesh.nodes().begin()));
}

class SortingKind : public OrderKind {};

TEST_P(SortingKind, SortsElementsByTheirNodes) {
    const TetMesh mesh = shuffled(two_boxes(), 6);
    const TetMesh ordered = lancet::mesh::reordered(mesh, lancet::mesh::order(mesh, GetParam()));
    Tetrahedron last{-1, -1, -1, -1};
    for (Tetrahedron t : ordered.tetrahedra()) {
        std::sort(t.begin(), t.end());
        EXPECT_LT(last, t);
        last = t;
    }
}

TEST_P(SortingKind, BringsNodesOfAnElementTogether) {
    const TetMesh mesh = shuffled(lancet::mesh::box({.cells = {24, 8, 8}, .size = {3, 1, 1}}), 7);
    const TetMesh ordered = lancet::mesh::reordered(mesh, lancet::mesh::order(mesh, GetParam()));
    EXPECT_LT(profile(ordered), profile(mesh) / 5);
}

TEST_P(OrderKind, AcceptsTheEmptyMesh) {
    EXPECT_TRUE(lancet::mesh::order(TetMesh(), GetParam()).node_of_new.empty());
}

std::string kind_name(const testing::TestParamInfo<OrderingKind>& instance) {
    switch (instance.param) {
        case OrderingKind::none:
            return "none";
        case OrderingKind::hilbert:
            return "hilbert";
        case OrderingKind::reverse_cuthill_mckee:
            return "reverse_cuthill_mckee";
    }
    return "unknown";
}

INSTANTIATE_TEST_SUITE_P(All, OrderKind,
                         testing::Values(OrderingKind::none, OrderingKind::hilbert,
                                         OrderingKind::reverse_cuthill_mckee),
                         kind_name);

INSTANTIATE_TEST_SUITE_P(All, SortingKind, testing::Values(OrderingKind::hilbert, OrderingKind::reverse_cuthill_mckee),
                         kind_name);

TEST(Order, NoneKeepsEverythingInItsPlace) {
    const TetMesh mesh = shuffled(two_boxes(), 4);
    const TetMesh ordered = lancet::mesh::reordered(mesh, lancet::mesh::order(mesh, OrderingKind::none));
    EXPECT_TRUE(std::equal(ordered.tetrahedra().begin(), ordered.tetrahedra().end(), mesh.tetrahedra().begin()));
    EXPECT_TRUE(std::equal(ordered.nodes().begin(), ordered.nodes().end(), mesh.nodes().begin()));
}

TEST(Order, HilbertVisitsNeighboursOneAfterTheOther) {
    // On a grid of 2^n places to a side the curve steps to an adjacent place each time.
    const TetMesh mesh = shuffled(lancet::mesh::box({.cells = {7, 7, 7}, .size = {7, 7, 7}}), 8);
    const Ordering ordering = lancet::mesh::order(mesh, OrderingKind::hilbert);
    for (std::size_t n = 1; n < ordering.node_of_new.size(); ++n) {
        const Point& a = mesh.nodes()[ordering.node_of_new[n - 1]];
        const Point& b = mesh.nodes()[ordering.node_of_new[n]];
        EXPECT_DOUBLE_EQ(std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]), 1.0) << n;
    }
}

TEST(Order, CuthillMcKeeBoundsTheBandwidthOfABar) {
    const TetMesh mesh = shuffled(lancet::mesh::box({.cells = {30, 2, 2}, .size = {30, 2, 2}}), 9);
    const TetMesh ordered =
        lancet::mesh::reordered(mesh, lancet::mesh::order(mesh, OrderingKind::reverse_cuthill_mckee));
    std::int32_t bandwidth = 0;
    for (const Tetrahedron& t : ordered.tetrahedra()) {
        const auto [low, high] = std::minmax_element(t.begin(), t.end());
        bandwidth = std::max(bandwidth, *high - *low);
    }
    // A cross section has nine nodes; a level of the search holds hardly more than one of them.
    EXPECT_LE(bandwidth, 27);
}

TEST(Order, RefusesWhatIsNotAPermutation) {
    const TetMesh mesh = lancet::mesh::box({});
    const Ordering good = lancet::mesh::order(mesh, OrderingKind::hilbert);
    Ordering bad = good;
    bad.node_of_new[0] = bad.node_of_new[1];
    EXPECT_THROW(lancet::mesh::reordered(mesh, bad), Error);
    bad = good;
    bad.new_of_element.pop_back();
    EXPECT_THROW(lancet::mesh::reordered(mesh, bad), Error);
    bad = good;
    bad.element_of_new[2] = -4;
    EXPECT_THROW(lancet::mesh::reordered(mesh, bad), Error);
}

}  // namespace
