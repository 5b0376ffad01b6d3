#include <set>
#include <tuple>

#include "tests/kernels/layout/layouts_under_test.hpp"
#include <gtest/gtest.h>

namespace lancet::test {
namespace {

class ElementBatches : public ::testing::TestWithParam<std::tuple<ScatterStrategy, int>> {};
INSTANTIATE_TEST_SUITE_P(StrategiesAndWidths, ElementBatches,
                         ::testing::Combine(::testing::ValuesIn(scatter_strategies), ::testing::Values(1, 4, 8, 16)),
                         layout_name);

TEST_P(ElementBatches, HoldEveryElementOnceAndPaddingWithoutWeight) {
    const auto [strategy, width] = GetParam();
    const ReferenceSolid solid = layout_solid();
    const NodeNumbering numbering = numbered(solid, layout_options);
    const auto batches = batches_of<double>(solid, numbering, strategy, width);
    ASSERT_EQ(batches.width, width);
    ASSERT_EQ(batches.block_batch_begin.size(), static_cast<std::size_t>(numbering.blocks()) + 1);
    ASSERT_EQ(batches.slot_of_element.size(), solid.tetrahedra.size());
    ASSERT_EQ(batches.nodes.size(), static_cast<std::size_t>(batches.slots()) * 4);

    std::set<std::int32_t> taken;
    const auto w = static_cast<std::size_t>(width);
    for (std::size_t e = 0; e < solid.tetrahedra.size(); ++e) {
        const std::int32_t slot = batches.slot_of_element[e];
        ASSERT_GE(slot, 0);
        ASSERT_LT(slot, batches.slots());
        EXPECT_TRUE(taken.insert(slot).second) << "two elements in slot " << slot;
        const std::size_t batch = static_cast<std::size_t>(slot) / w, lane = static_cast<std::size_t>(slot) % w;
        for (std::size_t corner = 0; corner < 4; ++corner) {
            EXPECT_EQ(batches.nodes[(batch * 4 + corner) * w + lane],
                      4 * numbering.internal_of_user[solid.tetrahedra[e][corner]]);
        }
        const double volume = solid.volume(e), mu = solid.material(e).mu();
        const double* rest = &batches.rest[batch * 11 * w + lane];
        // The determinant and its products round a few dozen times.
        EXPECT_NEAR(rest[9 * w] * rest[9 * w], volume * mu, 1e-14 * volume * mu);
        EXPECT_NEAR(rest[10 * w], solid.material(e).lambda() / mu, 1e-14 * solid.material(e).lambda() / mu);
        EXPECT_NEAR(batches.mass[batch * w + lane], solid.material(e).density * volume,
                    1e-14 * solid.material(e).density * volume);
        // b_j . (X_k - X_0) = delta_jk for the corners 1, 2, 3.
        for (std::size_t j = 0; j < 3; ++j) {
            for (std::size_t k = 0; k < 3; ++k) {
                double product = 0;
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    product += rest[(3 * j + axis) * w] * (solid.nodes[solid.tetrahedra[e][k + 1]][axis] -
                                                           solid.nodes[solid.tetrahedra[e][0]][axis]);
                }
                EXPECT_NEAR(product, j == k ? 1 : 0, 1e-13);
            }
        }
    }
    for (std::int32_t slot = 0; slot < batches.slots(); ++slot) {
        if (taken.contains(slot)) continue;
        const std::size_t batch = static_cast<std::size_t>(slot) / w, lane = static_cast<std::size_t>(slot) % w;
        EXPECT_EQ(batches.rest[(batch * 11 + 9) * w + lane], 0) << "the weight of padding";
        EXPECT_EQ(batches.mass[batch * w + lane], 0);
        for (std::size_t corner = 0; corner < 4; ++corner) {
            const std::int32_t node = batches.nodes[(batch * 4 + corner) * w + lane] / 4;
            ASSERT_GE(node, 0);
            ASSERT_LT(node, numbering.node_count);
        }
    }
    // Padding is less than a batch for each block.
    EXPECT_LT(static_cast<std::size_t>(batches.slots()),
              solid.tetrahedra.size() + w * static_cast<std::size_t>(numbering.blocks()));
    // Behind the last batch lies one of zeros, which assembly reads for 'nothing'.
    ASSERT_EQ(batches.rest.size(), static_cast<std::size_t>(batches.batches() + 1) * 11 * w);
    for (std::size_t i = static_cast<std::size_t>(batches.batches()) * 11 * w; i < batches.rest.size(); ++i) {
        EXPECT_EQ(batches.rest[i], 0);
    }
}

TEST_P(ElementBatches, AnElementLiesInABlockOfOneOfItsNodes) {
    const auto [strategy, width] = GetParam();
    const ReferenceSolid solid = layout_solid();
    const NodeNumbering numbering = numbered(solid, layout_options);
    const auto batches = batches_of<float>(solid, numbering, strategy, width);
    for (std::size_t e = 0; e < solid.tetrahedra.size(); ++e) {
        const std::int32_t batch = batches.slot_of_element[e] / width;
        int block = 0;
        while (batches.block_batch_begin[block + 1] <= batch) ++block;
        bool touches = false;
        for (const std::int32_t node : solid.tetrahedra[e]) {
            const std::int32_t internal = numbering.internal_of_user[node];
            touches = touches || (numbering.is_free(internal) && numbering.block_of(internal) == block);
        }
        EXPECT_TRUE(touches);
    }
}

}  // namespace
}  // namespace lancet::test
