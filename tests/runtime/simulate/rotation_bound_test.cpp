// Rotations that stay where little has changed.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/simulate/body.hpp"

namespace lancet::test {
namespace {

using mesh::Point;
using runtime::OperatorKind;
using runtime::ScalarMode;

/// A bar held at one end; most of its blocks follow the free end late.
runtime::Scene bar() {
    runtime::Scene scene;
    scene.mesh = mesh::box({.cells = {16, 3, 3}, .size = {1.6, 0.3, 0.3}});
    scene.materials = {{0, {.young_modulus = 1e5, .poisson_ratio = 0.33, .density = 100}}};
    const auto left = scene.mesh.node_set("x_min");
    scene.fixed_nodes.assign(left.begin(), left.end());
    scene.rayleigh_mass = 6;
    return scene;
}

struct Motion {
    std::vector<Point> positions;
    std::int64_t kept = 0;
    int blocks = 0;
};

class RotationBound : public ::testing::TestWithParam<std::tuple<OperatorKind, ScalarMode, runtime::SchedulerKind>> {
  protected:
    static Motion run(double bound, int steps) {
        const runtime::SchedulerKind kind = std::get<2>(GetParam());
        const auto matrix = std::get<0>(GetParam());
        const auto scalar = std::get<1>(GetParam());
        const auto scheduler = runtime::make_scheduler(kind, kind == runtime::SchedulerKind::serial ? 1 : 2);
        runtime::Settings settings{.time_step = 0.02};
        settings.matrix = matrix;
        settings.scalar = scalar;
        settings.rotation_bound = bound;
        settings.numbering = {.nodes_per_block = 32, .nodes_per_aggregate = 32};
        settings.conjugate_gradients = {.iterations = 60, .tolerance = 1e-6};
        const auto body = make_body(bar(), settings, *scheduler);
        for (int step = 0; step < steps; ++step) body->step(*scheduler);
        Motion end;
        end.positions.resize(body->nodes());
        body->positions(end.positions);
        end.kept = body->totals().kept_rotations;
        end.blocks = body->blocks();
        return end;
    }

    static double distance(const Motion& a, const Motion& b) {
        double largest = 0;
        for (std::size_t k = 0; k < a.positions.size(); ++k) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                largest = std::max(largest, std::abs(a.positions[k][axis] - b.positions[k][axis]));
            }
        }
        return largest;
    }
};

class RotationBoundAtRest : public RotationBound {};

const auto all_operators =
    ::testing::Values(OperatorKind::matrix_free, OperatorKind::edge_blocks, OperatorKind::block_rows);
const auto both_scalars = ::testing::Values(ScalarMode::single_precision, ScalarMode::double_precision);
constexpr auto serial = runtime::SchedulerKind::serial, threads = runtime::SchedulerKind::threads;

std::string name_of(const ::testing::TestParamInfo<RotationBound::ParamType>& instance) {
    std::string name = std::string(to_string(std::get<0>(instance.param))) + "_" +
                       std::string(to_string(std::get<1>(instance.param))) + "_" +
                       std::string(to_string(std::get<2>(instance.param)));
    std::ranges::replace(name, '-', '_');
    return name;
}

INSTANTIATE_TEST_SUITE_P(Bodies, RotationBound,
                         ::testing::Combine(all_operators, both_scalars, ::testing::Values(serial, threads)), name_of);
INSTANTIATE_TEST_SUITE_P(Bodies, RotationBoundAtRest,
                         ::testing::Combine(all_operators, both_scalars, ::testing::Values(serial)), name_of);

TEST_P(RotationBound, ThatNothingKeepsChangesNoBit) {
    const Motion without = run(0, 40), with = run(1e-300, 40);
    EXPECT_EQ(with.kept, 0);
    EXPECT_EQ(distance(without, with), 0);
}

// A rotation that is off by the bound b turns a force by as much: the strains of this bar, a few percent, err by b of
// themselves, and so does its deflection of 1 m at most.
TEST_P(RotationBound, KeepsRotationsAtAnErrorOfItsSize) {
    const Motion exact = run(0, 40);
    std::int64_t kept = 0;
    for (const double bound : {0.003, 0.03}) {
        SCOPED_TRACE(bound);
        const Motion run_with = run(bound, 40);
        EXPECT_GT(run_with.kept, kept);
        EXPECT_LE(distance(exact, run_with), bound);
        kept = run_with.kept;
    }
}

// Come to rest, none is renewed.
TEST_P(RotationBoundAtRest, KeepsAllAtRest) {
    const Motion moving = run(1e-3, 400), resting = run(1e-3, 420);
    EXPECT_EQ(resting.kept - moving.kept, 20 * resting.blocks);
    EXPECT_LE(distance(run(0, 420), resting), 1e-3);
}

}  // namespace
}  // namespace lancet::test
