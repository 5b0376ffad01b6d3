// Lanes with a floor under their fractions.
#include "lancet/mesh/cut/lanes.hpp"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/generate/box.hpp"

namespace lancet::test {
namespace {

using mesh::CutMesh;
using mesh::CutSurface;
using mesh::Lanes;

TEST(RaiseFractions, BringsThinLanesUpAndLeavesTheirCentresAndAllOthers) {
    CutMesh cut(mesh::box({.cells = {2, 2, 2}}));
    cut.cut(CutSurface::plane({0.51, 0, 0}, {1, 0.1, 0.2}));
    const Lanes before = mesh::lanes(cut);
    Lanes after = before;
    constexpr double floor = 0.125;
    raise_fractions(after, floor);
    ASSERT_EQ(after.lanes.size(), before.lanes.size());
    int raised = 0;
    for (std::size_t k = 0; k < before.lanes.size(); ++k) {
        const mesh::PartMoments &was = before.lanes[k].moments, &is = after.lanes[k].moments;
        EXPECT_EQ(is.fraction, std::max(was.fraction, floor));
        raised += was.fraction < floor ? 1 : 0;
        for (std::size_t i = 0; i < 4; ++i) {
            EXPECT_NEAR(is.first[i] / is.fraction, was.first[i] / was.fraction, 1e-14);
            double row = 0;
            for (std::size_t j = 0; j < 4; ++j) row += is.second[i][j];
            EXPECT_NEAR(row, is.first[i], 1e-15);
            if (was.fraction >= floor) {
                EXPECT_EQ(is.first[i], was.first[i]);
            }
        }
    }
    EXPECT_GT(raised, 0);
    Lanes same = before;
    raise_fractions(same, 0);
    for (std::size_t k = 0; k < before.lanes.size(); ++k) {
        EXPECT_EQ(same.lanes[k].moments.fraction, before.lanes[k].moments.fraction);
    }
}

TEST(RaiseFractions, TakesPartsWithoutVolumeAndRefusesOtherFloors) {
    Lanes lanes{.lanes = {{0, {0, 1, 2, 3}, mesh::empty_moments()}}, .node_of_copy = {0, 1, 2, 3}, .opened_from = {}};
    raise_fractions(lanes, 0.01);
    EXPECT_EQ(lanes.lanes[0].moments.fraction, 0.01);
    EXPECT_NEAR(lanes.lanes[0].moments.first[2], 0.0025, 1e-17);
    for (const double bad : {-0.1, 1.0, std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_THROW(raise_fractions(lanes, bad), Error);
    }
}

}  // namespace
}  // namespace lancet::test
