#include "tests/runtime/solve/linear_system.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::test {
namespace {

TEST(ConstraintFilter, ProjectsTheNodesOfEachBlock) {
    ReferenceSolid solid = jittered_bar({5, 3, 2}, 0.1, 0.15, 161);
    const NodeNumbering numbering = numbered(solid, layout_options);
    ASSERT_GT(numbering.blocks(), 2);
    const std::vector<NodeHold> holds{
        {40, Eigen::Vector3d::Zero()}, {3, Eigen::Vector3d(2, -1, 2) / 3}, {60, Eigen::Vector3d(0, 1, 0)}};
    const auto filter = filter_of(holds, numbering);
    EXPECT_FALSE(filter.empty());
    EXPECT_TRUE(runtime::ConstraintFilter().empty());
    kernels::AlignedVector<double> nodal(static_cast<std::size_t>(numbering.node_count) * 4, 0.0);
    for (std::size_t i = 0; i < nodal.size(); ++i) nodal[i] = 1.0 + static_cast<double>(i);
    const auto before = nodal;
    for (int block = 0; block < numbering.blocks(); ++block) filter.apply(nodal.data(), block);
    for (std::size_t node = 0; node < solid.nodes.size(); ++node) {
        const std::size_t at = 4 * static_cast<std::size_t>(numbering.internal_of_user[node]);
        const Eigen::Vector3d old(before[at], before[at + 1], before[at + 2]);
        Eigen::Vector3d expected = old;
        for (const NodeHold& hold : holds) {
            if (hold.node != static_cast<std::int32_t>(node)) continue;
            expected = hold.direction.isZero() ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                                               : Eigen::Vector3d(old - hold.direction.dot(old) * hold.direction);
        }
        const Eigen::Vector3d now(nodal[at], nodal[at + 1], nodal[at + 2]);
        EXPECT_LE((now - expected).norm(), 1e-15 * old.norm()) << node;
        EXPECT_EQ(nodal[at + 3], before[at + 3]);
    }
}

TEST(ConstraintFilter, RefusesFixedAndRepeatedNodes) {
    ReferenceSolid solid = jittered_bar({5, 3, 2}, 0.1, 0.15, 162);
    fix_first_section(solid, {5, 3, 2});
    const NodeNumbering numbering = numbered(solid, layout_options);
    const Eigen::Vector3d all = Eigen::Vector3d::Zero();
    EXPECT_NO_THROW(filter_of({{1, all}, {2, all}}, numbering));
    EXPECT_THROW(filter_of({{0, all}}, numbering), Error);
    EXPECT_THROW(filter_of({{1, all}, {2, all}, {1, all}}, numbering), Error);
    EXPECT_THROW(runtime::ConstraintFilter({{-1, {}}}, numbering), Error);
}

}  // namespace
}  // namespace lancet::test
