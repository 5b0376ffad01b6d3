#include "lancet/kernels/layout/vertex_rings.hpp"

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "tests/kernels/surface/surfaces.hpp"
#include <gtest/gtest.h>

namespace lancet::kernels::test {

namespace {

using Ring = std::vector<std::int32_t>;

/// The slots of each vertex, as far as its batch has them.
std::vector<Ring> rings_of(const VertexRings& rings, std::size_t vertices) {
    std::vector<Ring> found(vertices);
    for (int batch = 0; batch < rings.batches(); ++batch) {
        for (int lane = 0; lane < VertexRings::lanes; ++lane) {
            const auto vertex = static_cast<std::size_t>(rings.vertices[batch * VertexRings::lanes + lane] / 3);
            Ring& ring = found.at(vertex);
            ring.clear();
            for (int slot = rings.slot_begin[batch]; slot < rings.slot_begin[batch + 1]; ++slot) {
                ring.push_back(rings.neighbours[slot * VertexRings::lanes + lane] / 3);
            }
        }
    }
    return found;
}

/// What follows each other in the slots of a vertex, as the triangles that they are.
std::multiset<Triangle> triangles_of(const Ring& ring, std::int32_t vertex) {
    std::multiset<Triangle> triangles;
    for (std::size_t k = 1; k < ring.size(); ++k) {
        if (ring[k - 1] != vertex && ring[k] != vertex) triangles.insert({vertex, ring[k - 1], ring[k]});
    }
    return triangles;
}

void expect_all_triangles(std::size_t vertices, std::span<const Triangle> triangles) {
    const VertexRings rings = vertex_rings(vertices, triangles);
    std::vector<std::multiset<Triangle>> expected(vertices);
    for (const Triangle& t : triangles) {
        if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            expected[static_cast<std::size_t>(t[k])].insert({t[k], t[(k + 1) % 3], t[(k + 2) % 3]});
        }
    }
    const std::vector<Ring> found = rings_of(rings, vertices);
    for (std::size_t vertex = 0; vertex < vertices; ++vertex) {
        EXPECT_EQ(triangles_of(found[vertex], static_cast<std::int32_t>(vertex)), expected[vertex]) << vertex;
    }
}

}  // namespace

TEST(VertexRings, HoldEachTriangleOncePerCorner) {
    std::mt19937_64 random(3);
    const Surface torus = rough_torus(50, 30, 0, random);
    ASSERT_GT(torus.places.size(), 1024U) << "more than a block";
    expect_all_triangles(torus.places.size(), torus.triangles);
    // Triangles that do not hang together in any order, with edges of many and repeated vertices.
    for (int round = 0; round < 50; ++round) {
        const auto vertices = 3 + random() % 40;
        std::vector<Triangle> soup(random() % 200);
        for (Triangle& triangle : soup) {
            for (std::int32_t& vertex : triangle) vertex = static_cast<std::int32_t>(random() % vertices);
        }
        expect_all_triangles(vertices, soup);
    }
    expect_all_triangles(0, {});
    expect_all_triangles(5, {});
}

TEST(VertexRings, GoAroundClosedSurfacesWithoutAGap) {
    std::mt19937_64 random(4);
    const Surface torus = rough_torus(40, 20, 0, random);
    const VertexRings rings = vertex_rings(torus.places.size(), torus.triangles);
    std::map<std::int32_t, std::size_t> around;
    for (const Triangle& triangle : torus.triangles) {
        for (const std::int32_t vertex : triangle) ++around[vertex];
    }
    const std::vector<Ring> found = rings_of(rings, torus.places.size());
    for (std::size_t vertex = 0; vertex < found.size(); ++vertex) {
        const std::size_t triangles = around[static_cast<std::int32_t>(vertex)];
        ASSERT_GT(found[vertex].size(), triangles);
        EXPECT_EQ(found[vertex].front(), found[vertex][triangles]);
        const std::set<std::int32_t> all(found[vertex].begin(), found[vertex].begin() + triangles);
        EXPECT_EQ(all.size(), triangles);
    }
}

TEST(VertexRings, PutVerticesOfAsManyNeighboursTogether) {
    std::mt19937_64 random(5);
    const Surface torus = rough_torus(100, 30, 0, random);
    const VertexRings rings = vertex_rings(torus.places.size(), torus.triangles);
    EXPECT_EQ(rings.blocks(), 3);
    std::set<std::int32_t> seen(rings.vertices.begin(), rings.vertices.end());
    EXPECT_EQ(seen.size(), torus.places.size());
    // Of all slots hardly any are filled up: each triangle has one at each corner, and each vertex one more.
    const std::size_t needed = 3 * torus.triangles.size() + torus.places.size();
    EXPECT_LT(static_cast<double>(rings.neighbours.size()), 1.05 * static_cast<double>(needed));
    EXPECT_GT(rings.bytes(), sizeof(std::int32_t) * needed);
}

TEST(VertexRings, TakeLittleTimeForAVertexOfManyTriangles) {
    // In squares of this number it would take minutes.
    constexpr std::int32_t around = 200000;
    std::vector<Triangle> triangles;
    for (std::int32_t k = 0; k < around; ++k) triangles.push_back({0, 1 + (k * 7 + 1) % around, 1 + (k * 7) % around});
    const VertexRings rings = vertex_rings(around + 1, triangles);
    EXPECT_GT(rings.neighbours.size(), static_cast<std::size_t>(around));
}

}  // namespace lancet::kernels::test
