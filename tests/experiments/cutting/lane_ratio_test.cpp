// What a cut element costs over an uncut one.
#include "lancet/experiments/cutting/lane_ratio.hpp"

#include <gtest/gtest.h>

namespace lancet::experiments::cutting {
namespace {

TEST(LaneRatio, CountsLanesNodesAndEdges) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    for (const runtime::ScalarMode scalar :
         {runtime::ScalarMode::single_precision, runtime::ScalarMode::double_precision}) {
        const LaneRatio ratio = measure_lane_ratio(bar(true), {.scalar = scalar}, 0.04, *scheduler, 3);
        EXPECT_EQ(ratio.lanes, 2);
        // 20 layers of cells and 21 of nodes: each layer that lies between two cuts is there three times, once with the
        // part that holds it and once behind each cut; the ends are there twice.
        EXPECT_DOUBLE_EQ(ratio.nodes, (3.0 * 19 + 2 * 2) / 21);
        EXPECT_GT(ratio.edges, 2);
        EXPECT_LT(ratio.edges, 3);
        EXPECT_GT(ratio.force_ns, 0);
        EXPECT_GT(ratio.product_ns, 0);
        // Times on a busy machine say no more than this.
        EXPECT_GT(ratio.force, 0);
        EXPECT_GT(ratio.product, 0);
        EXPECT_GT(ratio.both, 0);
    }
}

}  // namespace
}  // namespace lancet::experiments::cutting
