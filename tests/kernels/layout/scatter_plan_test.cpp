#include <set>
#include <tuple>

#include "tests/kernels/layout/layouts_under_test.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::test {
namespace {

class ScatterPlan : public ::testing::TestWithParam<std::tuple<ScatterStrategy, int>> {
  protected:
    ReferenceSolid solid = layout_solid();
    NodeNumbering numbering = numbered(solid, layout_options);
    kernels::ElementBatches<double> batches =
        batches_of<double>(solid, numbering, std::get<0>(GetParam()), std::get<1>(GetParam()));
    std::size_t width = static_cast<std::size_t>(batches.width);

    bool is_padding(std::size_t batch, std::size_t lane) const { return batches.mass[batch * width + lane] == 0; }
    template <class Visit>
    void for_each_lane(int block, Visit visit) const {
        for (std::int32_t b = batches.block_batch_begin[block]; b < batches.block_batch_begin[block + 1]; ++b) {
            for (std::size_t corner = 0; corner < 4; ++corner) {
                for (std::size_t lane = 0; lane < width; ++lane) visit(static_cast<std::size_t>(b), corner, lane);
            }
        }
    }
    std::size_t place(std::size_t batch, std::size_t corner, std::size_t lane) const {
        return (batch * 4 + corner) * width + lane;
    }
};
INSTANTIATE_TEST_SUITE_P(StrategiesAndWidths, ScatterPlan,
                         ::testing::Combine(::testing::ValuesIn(scatter_strategies), ::testing::Values(1, 4, 8, 16)),
                         layout_name);

TEST_P(ScatterPlan, SumsWhatANaiveLoopSums) {
    const kernels::ScatterPlan& plan = batches.scatter;
    // Integers: every order of summation gives the same. What padding writes must reach nobody.
    const auto value = [](std::size_t at) { return static_cast<double>(1 + (at * 2654435761U) % 1000003U); };
    constexpr double of_padding = 1e9;
    std::vector<double> expected(static_cast<std::size_t>(numbering.node_count), 0.0);
    std::vector<double> buffer(static_cast<std::size_t>(plan.buffer_size()), 0.0);
    for (const auto& color : plan.colors()) {
        for (const std::int32_t block : color) {
            for_each_lane(block, [&](std::size_t batch, std::size_t corner, std::size_t lane) {
                const std::size_t at = place(batch, corner, lane);
                ASSERT_GE(batches.targets[at], 0);
                ASSERT_LT(batches.targets[at] / 4, plan.buffer_size());
                if (is_padding(batch, lane)) {
                    buffer[batches.targets[at] / 4] += of_padding;
                } else {
                    buffer[batches.targets[at] / 4] += value(at);
                    expected[batches.nodes[at] / 4] += value(at);
                }
            });
        }
    }
    for (int block = 0; block < numbering.blocks(); ++block) {
        for (std::int32_t k = plan.merge_begin()[block]; k < plan.merge_begin()[block + 1]; ++k) {
            const auto [node, slot] = plan.merges()[k];
            EXPECT_EQ(numbering.block_of(node), block) << "a block merges its own nodes alone";
            EXPECT_GE(slot, numbering.node_count);
            buffer[node] += buffer[slot];
        }
    }
    for (std::int32_t node = 0; node < numbering.free_count; ++node) EXPECT_EQ(buffer[node], expected[node]) << node;
}

TEST_P(ScatterPlan, BlocksOfAColorWriteToDisjointPlaces) {
    const kernels::ScatterPlan& plan = batches.scatter;
    std::set<std::int32_t> blocks_seen;
    for (const auto& color : plan.colors()) {
        std::set<std::int32_t> written;
        for (const std::int32_t block : color) {
            EXPECT_TRUE(blocks_seen.insert(block).second) << "block " << block << " has two colors";
            std::set<std::int32_t> of_block;
            for_each_lane(block, [&](std::size_t batch, std::size_t corner, std::size_t lane) {
                of_block.insert(batches.targets[place(batch, corner, lane)] / 4);
            });
            for (const std::int32_t target : of_block) {
                EXPECT_TRUE(written.insert(target).second) << "two blocks of a color write to " << target;
                if (plan.strategy() == ScatterStrategy::private_copies && target < numbering.node_count) {
                    EXPECT_EQ(numbering.block_of(target), block);
                }
                if (target >= numbering.node_count) {
                    EXPECT_GE(target, plan.slot_begin()[block]);
                    EXPECT_LT(target, plan.slot_begin()[block + 1]);
                }
            }
        }
    }
    EXPECT_EQ(blocks_seen.size(), static_cast<std::size_t>(numbering.blocks()));
    if (plan.strategy() == ScatterStrategy::coloring) {
        EXPECT_GT(plan.colors().size(), 1U) << "neighbouring blocks share nodes";
        EXPECT_TRUE(plan.merges().empty());
    } else {
        EXPECT_EQ(plan.colors().size(), 1U);
    }
}

class NodeGather : public ScatterPlan {};
INSTANTIATE_TEST_SUITE_P(Widths, NodeGather,
                         ::testing::Combine(::testing::Values(ScatterStrategy::node_gather),
                                            ::testing::Values(1, 4, 8, 16)),
                         layout_name);

TEST_P(NodeGather, GivesEveryContributionASlot) {
    const kernels::ScatterPlan& plan = batches.scatter;
    std::set<std::int32_t> slots;
    std::size_t to_free_nodes = 0;
    for (int block = 0; block < numbering.blocks(); ++block) {
        for_each_lane(block, [&](std::size_t batch, std::size_t corner, std::size_t lane) {
            const std::size_t at = place(batch, corner, lane);
            EXPECT_GE(batches.targets[at] / 4, numbering.node_count) << "nothing is added to a node directly";
            if (is_padding(batch, lane) || !numbering.is_free(batches.nodes[at] / 4)) return;
            ++to_free_nodes;
            EXPECT_TRUE(slots.insert(batches.targets[at] / 4).second);
        });
    }
    EXPECT_EQ(slots.size(), to_free_nodes);
    EXPECT_EQ(plan.merges().size(), to_free_nodes);
}

TEST_P(ScatterPlan, MergesInAFixedOrder) {
    const auto& merges = batches.scatter.merges();
    for (std::size_t k = 1; k < merges.size(); ++k) {
        EXPECT_LT(std::tie(merges[k - 1].node, merges[k - 1].slot), std::tie(merges[k].node, merges[k].slot));
    }
}

TEST(ScatterStrategy, HasNames) {
    for (const ScatterStrategy strategy : scatter_strategies) {
        EXPECT_EQ(kernels::scatter_strategy_from_string(to_string(strategy)), strategy);
    }
    EXPECT_THROW(kernels::scatter_strategy_from_string("atomic"), Error);
}

}  // namespace
}  // namespace lancet::test
