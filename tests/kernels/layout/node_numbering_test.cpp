#include <algorithm>
#include <numeric>
#include <set>

#include "tests/kernels/layout/layouts_under_test.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::test {
namespace {

void expect_consistent(const ReferenceSolid& solid, const NodeNumbering& numbering) {
    const std::vector<std::uint8_t> fixed = fixed_flags(solid);
    ASSERT_EQ(numbering.internal_of_user.size(), solid.nodes.size());
    ASSERT_EQ(numbering.user_of_internal.size(), static_cast<std::size_t>(numbering.node_count));
    // A permutation, apart from unused places.
    for (std::size_t node = 0; node < solid.nodes.size(); ++node) {
        const std::int32_t internal = numbering.internal_of_user[node];
        ASSERT_GE(internal, 0);
        ASSERT_LT(internal, numbering.node_count);
        EXPECT_EQ(numbering.user_of_internal[internal], static_cast<std::int32_t>(node));
        EXPECT_EQ(numbering.is_free(internal), fixed[node] == 0);
    }
    const auto used = std::count_if(numbering.user_of_internal.begin(), numbering.user_of_internal.end(),
                                    [](std::int32_t user) { return user >= 0; });
    EXPECT_EQ(static_cast<std::size_t>(used), solid.nodes.size());

    // Blocks and aggregates: aligned, in order, without gaps.
    EXPECT_EQ(numbering.node_count % NodeNumbering::alignment, 0);
    EXPECT_EQ(numbering.free_count % NodeNumbering::alignment, 0);
    ASSERT_EQ(numbering.block_begin.front(), 0);
    ASSERT_EQ(numbering.block_begin.back(), numbering.free_count);
    ASSERT_EQ(numbering.aggregate_begin.back(), numbering.free_count);
    ASSERT_EQ(numbering.block_aggregate_begin.front(), 0);
    ASSERT_EQ(numbering.block_aggregate_begin.back(), numbering.aggregates());
    for (int block = 0; block < numbering.blocks(); ++block) {
        EXPECT_EQ(numbering.block_begin[block] % NodeNumbering::alignment, 0);
        EXPECT_LT(numbering.block_begin[block], numbering.block_begin[block + 1]);
        EXPECT_EQ(numbering.aggregate_begin[numbering.block_aggregate_begin[block]], numbering.block_begin[block]);
        EXPECT_LT(numbering.block_aggregate_begin[block], numbering.block_aggregate_begin[block + 1]);
        for (std::int32_t node = numbering.block_begin[block]; node < numbering.block_begin[block + 1]; ++node) {
            ASSERT_EQ(numbering.block_of(node), block);
        }
    }
    for (int aggregate = 0; aggregate < numbering.aggregates(); ++aggregate) {
        EXPECT_EQ(numbering.aggregate_begin[aggregate] % NodeNumbering::alignment, 0);
        EXPECT_LT(numbering.aggregate_begin[aggregate], numbering.aggregate_begin[aggregate + 1]);
    }
}

std::vector<std::set<std::int32_t>> neighbours(const ReferenceSolid& solid) {
    std::vector<std::set<std::int32_t>> neighbours(solid.nodes.size());
    for (const Tetrahedron& t : solid.tetrahedra) {
        for (const std::int32_t a : t) {
            for (const std::int32_t b : t) {
                if (a != b) neighbours[a].insert(b);
            }
        }
    }
    return neighbours;
}

/// The user's numbers of the nodes in [begin, end).
std::set<std::int32_t> members(const NodeNumbering& numbering, std::int32_t begin, std::int32_t end) {
    std::set<std::int32_t> members;
    for (std::int32_t node = begin; node < end; ++node) {
        if (numbering.user_of_internal[node] >= 0) members.insert(numbering.user_of_internal[node]);
    }
    return members;
}

bool is_connected(const std::set<std::int32_t>& nodes, const std::vector<std::set<std::int32_t>>& neighbours) {
    std::set<std::int32_t> reached{*nodes.begin()};
    std::vector<std::int32_t> front{*nodes.begin()};
    while (!front.empty()) {
        const std::int32_t node = front.back();
        front.pop_back();
        for (const std::int32_t next : neighbours[node]) {
            if (nodes.contains(next) && reached.insert(next).second) front.push_back(next);
        }
    }
    return reached == nodes;
}

void expect_connected_aggregates(const ReferenceSolid& solid, const NodeNumbering& numbering) {
    const auto adjacent = neighbours(solid);
    for (int aggregate = 0; aggregate < numbering.aggregates(); ++aggregate) {
        const auto nodes =
            members(numbering, numbering.aggregate_begin[aggregate], numbering.aggregate_begin[aggregate + 1]);
        ASSERT_FALSE(nodes.empty());
        EXPECT_TRUE(is_connected(nodes, adjacent)) << "aggregate " << aggregate;
    }
}

TEST(NodeNumbering, IsAPermutationInAlignedPieces) {
    const ReferenceSolid solid = layout_solid();
    for (const int per_block : {0, 1, 5, 20, 1000}) {
        for (const int per_aggregate : {0, 1, 2, 7, 100}) {
            SCOPED_TRACE(testing::Message() << per_block << " nodes a block, " << per_aggregate << " an aggregate");
            const NodeNumbering numbering =
                numbered(solid, {.nodes_per_block = per_block, .nodes_per_aggregate = per_aggregate});
            expect_consistent(solid, numbering);
            expect_connected_aggregates(solid, numbering);
        }
    }
}

TEST(NodeNumbering, MakesBlocksOfEqualSize) {
    const ReferenceSolid solid = layout_solid();
    const NodeNumbering numbering = numbered(solid, layout_options);
    const std::size_t free_nodes = solid.nodes.size() - solid.fixed.size();
    ASSERT_EQ(numbering.blocks(), static_cast<int>((free_nodes + 19) / 20));
    const auto blocks = static_cast<std::size_t>(numbering.blocks());
    std::size_t smallest = free_nodes, largest = 0;
    for (int block = 0; block < numbering.blocks(); ++block) {
        const std::size_t size =
            members(numbering, numbering.block_begin[block], numbering.block_begin[block + 1]).size();
        smallest = std::min(smallest, size);
        largest = std::max(largest, size);
    }
    // Each bisection rounds once: half a node for each of log2(blocks) levels.
    EXPECT_GE(smallest + 3, free_nodes / blocks);
    EXPECT_LE(largest, free_nodes / blocks + 3);
}

TEST(NodeNumbering, MakesAggregatesOfTheSizeAskedFor) {
    const ReferenceSolid solid = jittered_bar({12, 4, 4}, 0.1, 0.1, 3);
    const NodeNumbering numbering = numbered(solid, {.nodes_per_block = 130, .nodes_per_aggregate = 30});
    // Equal pieces of each block, of between two thirds and three halves of what was asked for, where none was split.
    for (int aggregate = 0; aggregate < numbering.aggregates(); ++aggregate) {
        const auto nodes =
            members(numbering, numbering.aggregate_begin[aggregate], numbering.aggregate_begin[aggregate + 1]);
        EXPECT_LE(nodes.size(), 45U);
    }
    EXPECT_GE(numbering.aggregates(), static_cast<int>(solid.nodes.size() / 45));
}

TEST(NodeNumbering, SplitsAggregatesAtAGap) {
    // Two bars that touch nowhere, side by side along their whole length: halves across the length hold parts of both.
    ReferenceSolid solid = jittered_bar({12, 1, 1}, 0.1, 0.0, 4);
    const ReferenceSolid other = solid;
    const auto offset = static_cast<std::int32_t>(solid.nodes.size());
    for (const Point& p : other.nodes) solid.nodes.push_back({p[0], p[1] + 0.15, p[2]});
    for (Tetrahedron t : other.tetrahedra) {
        for (std::int32_t& node : t) node += offset;
        solid.tetrahedra.push_back(t);
        solid.regions.push_back(0);
    }
    const NodeNumbering numbering = numbered(solid, {.nodes_per_block = 60, .nodes_per_aggregate = 20});
    expect_consistent(solid, numbering);
    expect_connected_aggregates(solid, numbering);
}

TEST(NodeNumbering, TakesBodiesWithoutFreeNodesAndWithoutFixedOnes) {
    ReferenceSolid solid = jittered_bar({2, 1, 1}, 0.1, 0.0, 5);
    expect_consistent(solid, numbered(solid, {}));
    solid.fixed.resize(solid.nodes.size());
    std::iota(solid.fixed.begin(), solid.fixed.end(), 0);
    const NodeNumbering numbering = numbered(solid, {});
    EXPECT_EQ(numbering.free_count, 0);
    EXPECT_EQ(numbering.blocks(), 0);
    EXPECT_EQ(numbering.aggregates(), 0);
}

TEST(NodeNumbering, RefusesFlagsAndRanksOfAnotherMesh) {
    const ReferenceSolid solid = layout_solid();
    const std::vector<std::int32_t> rank(solid.nodes.size());
    const std::vector<std::uint8_t> too_few(solid.nodes.size() - 1);
    EXPECT_THROW(kernels::number_nodes(solid.nodes, solid.tetrahedra, too_few, rank), Error);
}

}  // namespace
}  // namespace lancet::test
