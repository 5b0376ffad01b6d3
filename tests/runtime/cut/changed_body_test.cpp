// A body that cuts change in place is the body that is laid out anew after each cut.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/cut/cuttable_body.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"

namespace lancet::test {
namespace {

using mesh::CutSurface;
using mesh::Point;
using runtime::CuttableBody;
using runtime::DeformableBody;
using runtime::MassKind;
using runtime::OperatorKind;
using runtime::ScalarMode;
using runtime::Settings;

runtime::Scene bar() {
    runtime::Scene scene;
    scene.mesh = mesh::box({.cells = {8, 3, 3}, .size = {0.8, 0.3, 0.3}});
    scene.materials = {{0, {.young_modulus = 1e5, .poisson_ratio = 0.33, .density = 500}}};
    const auto left = scene.mesh.node_set("x_min");
    scene.fixed_nodes.assign(left.begin(), left.end());
    const auto right = scene.mesh.node_set("x_max");
    scene.prescribed.push_back({right.front(), 2, [](double time) { return 0.02 * time; }});
    scene.nodal_loads.push_back({right.back(), {0, 1, 0}});
    return scene;
}

/// Half discs, so to say: parallelograms here and there, some through the fixed end.
CutSurface random_cut(std::mt19937& random) {
    std::uniform_real_distribution<double> unit(-1, 1);
    const auto vector = [&](double size) {
        return Point{size * unit(random), size * unit(random), size * unit(random)};
    };
    const Point middle{0.4 + 0.42 * unit(random), 0.15 + 0.15 * unit(random), 0.15 + 0.15 * unit(random)};
    const Point first = vector(0.25), second = vector(0.25);
    Point corner = middle;
    for (std::size_t axis = 0; axis < 3; ++axis) corner[axis] -= 0.5 * (first[axis] + second[axis]);
    return CutSurface::parallelogram(corner, first, second);
}

std::vector<Point> positions(const DeformableBody& body) {
    std::vector<Point> values(body.nodes());
    body.positions(values);
    return values;
}

std::vector<Point> velocities(const DeformableBody& body) {
    std::vector<Point> values(body.nodes());
    body.velocities(values);
    return values;
}

double largest(const std::vector<Point>& values) {
    double size = 0;
    for (const Point& value : values) {
        for (const double component : value) size = std::max(size, std::abs(component));
    }
    return size;
}

double largest_difference(const std::vector<Point>& a, const std::vector<Point>& b) {
    double size = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        for (std::size_t axis = 0; axis < 3; ++axis) size = std::max(size, std::abs(a[k][axis] - b[k][axis]));
    }
    return size;
}

struct Case {
    std::string name;
    Settings settings{};
    runtime::SchedulerKind scheduler = runtime::SchedulerKind::serial;
    runtime::CrumbTreatment crumbs = runtime::CrumbTreatment::keep;
    mesh::Fronts fronts = mesh::Fronts::sharp;
};

/// Solves to the rounding of the scalar.
Case implicit(const std::string& name, OperatorKind matrix, ScalarMode scalar, MassKind mass) {
    Case of{.name = name};
    of.settings.time_step = 0.01;
    of.settings.matrix = matrix;
    of.settings.scalar = scalar;
    of.settings.mass = mass;
    of.settings.numbering = {.nodes_per_block = 48, .nodes_per_aggregate = 16};
    of.settings.conjugate_gradients = {.iterations = 600,
                                       .tolerance = scalar == ScalarMode::double_precision ? 1e-12 : 1e-6};
    return of;
}

std::vector<Case> cases() {
    std::vector<Case> all;
    for (const OperatorKind matrix : {OperatorKind::matrix_free, OperatorKind::edge_blocks, OperatorKind::block_rows}) {
        for (const ScalarMode scalar : {ScalarMode::single_precision, ScalarMode::double_precision}) {
            for (const MassKind mass : {MassKind::lumped, MassKind::fraction, MassKind::consistent}) {
                const std::string name = std::string(to_string(matrix)) + "_" + std::string(to_string(scalar)) + "_" +
                                         std::string(to_string(mass));
                all.push_back(implicit(name, matrix, scalar, mass));
            }
        }
    }
    Case weighted = implicit("weighted_diagonal", OperatorKind::edge_blocks, ScalarMode::double_precision,
                             MassKind::weighted_diagonal);
    weighted.scheduler = runtime::SchedulerKind::threads;
    all.push_back(weighted);
    Case linear = implicit("linear", OperatorKind::edge_blocks, ScalarMode::double_precision, MassKind::lumped);
    linear.settings.model = runtime::ElementModel::linear;
    all.push_back(linear);
    Case exact = implicit("exact_tangent", OperatorKind::edge_blocks, ScalarMode::double_precision, MassKind::lumped);
    exact.settings.tangent = runtime::TangentKind::projected;
    all.push_back(exact);
    Case watched =
        implicit("rotation_bound", OperatorKind::edge_blocks, ScalarMode::double_precision, MassKind::lumped);
    watched.settings.rotation_bound = 1e-10;  // far below the tolerance of positions
    all.push_back(watched);
    Case newmark = implicit("newmark", OperatorKind::edge_blocks, ScalarMode::double_precision, MassKind::lumped);
    newmark.settings.integrator = runtime::Integrator::newmark;
    newmark.settings.energy_safeguard = false;
    all.push_back(newmark);
    Case sparse = implicit("sparse_coarse", OperatorKind::edge_blocks, ScalarMode::double_precision, MassKind::lumped);
    sparse.settings.numbering = {.nodes_per_block = 24, .nodes_per_aggregate = 4};
    sparse.scheduler = runtime::SchedulerKind::threads;
    all.push_back(sparse);
    Case jacobi = implicit("block_jacobi", OperatorKind::edge_blocks, ScalarMode::double_precision, MassKind::lumped);
    jacobi.settings.preconditioner = runtime::PreconditionerKind::block_jacobi;
    all.push_back(jacobi);
    Case frozen = implicit("frozen_crumbs", OperatorKind::edge_blocks, ScalarMode::double_precision, MassKind::lumped);
    frozen.crumbs = runtime::CrumbTreatment::freeze;
    all.push_back(frozen);
    Case explicit_step{.name = "explicit"};
    explicit_step.settings.integrator = runtime::Integrator::central_differences;
    explicit_step.settings.time_step = 2e-4;
    explicit_step.settings.force_time_step = true;
    explicit_step.settings.energy_safeguard = false;
    explicit_step.settings.scalar = ScalarMode::double_precision;
    all.push_back(explicit_step);
    // Fronts that are blended move on through elements that were cut before.
    const std::size_t sharp = all.size();
    for (std::size_t k = 0; k < sharp; ++k) {
        Case blended = all[k];
        blended.name += "_blended";
        blended.fronts = mesh::Fronts::blended;
        all.push_back(blended);
    }
    return all;
}

class ChangedBody : public ::testing::TestWithParam<Case> {
  protected:
    /// Both bodies from the same motion, so that what they do next can be compared however often they are cut.
    static void set_motion(CuttableBody& body, const CuttableBody& like) {
        body.body().set_positions(positions(like.body()));
        body.body().set_velocities(velocities(like.body()));
    }
};

TEST_P(ChangedBody, IsTheBodyLaidOutAnewAfterEachOfManyCuts) {
    const Case& of = GetParam();
    const bool is_double = of.settings.scalar == ScalarMode::double_precision;
    const auto scheduler =
        runtime::make_scheduler(of.scheduler, of.scheduler == runtime::SchedulerKind::serial ? 1 : 2);
    const bool falls_back = of.settings.matrix == OperatorKind::block_rows;
    CuttableBody changed(bar(), of.settings, *scheduler, {.fronts = of.fronts, .crumbs = of.crumbs, .room = 1});
    CuttableBody rebuilt(bar(), of.settings, *scheduler, {.fronts = of.fronts, .crumbs = of.crumbs, .room = 0});
    std::mt19937 random(7);
    int in_place = 0, anew = 0;
    for (int round = 0; round < 14; ++round) {
        SCOPED_TRACE("cut " + std::to_string(round));
        for (CuttableBody* body : {&changed, &rebuilt}) body->step(*scheduler);
        set_motion(rebuilt, changed);
        const CutSurface surface = random_cut(random);
        const auto configuration = round % 3 == 0 ? runtime::Configuration::current : runtime::Configuration::rest;
        const runtime::CutUpdate update = changed.cut(*scheduler, surface, configuration),
                                 reference = rebuilt.cut(*scheduler, surface, configuration);
        if (reference.rebuilt) ++(update.rebuilt ? anew : in_place);
        ASSERT_EQ(changed.body().nodes(), rebuilt.body().nodes());
        EXPECT_EQ(changed.body().elements(), rebuilt.body().elements());
        const auto nodes = static_cast<std::int32_t>(rebuilt.body().nodes());

        // Sums in another order: some dozens of roundings of double.
        double mass = 0;
        for (std::int32_t node = 0; node < nodes; ++node) mass = std::max(mass, rebuilt.body().nodal_mass(node));
        for (std::int32_t node = 0; node < nodes; ++node) {
            const double expected = rebuilt.body().nodal_mass(node);
            EXPECT_NEAR(changed.body().nodal_mass(node), expected, 1e-14 * expected) << node;
        }
        EXPECT_LE(largest_difference(positions(changed.body()), positions(rebuilt.body())), 0);
        EXPECT_LE(largest_difference(velocities(changed.body()), velocities(rebuilt.body())),
                  1e-12 * largest(velocities(rebuilt.body())));

        ASSERT_EQ(update.crumbs.size(), reference.crumbs.size());
        for (std::size_t k = 0; k < update.crumbs.size(); ++k) {
            EXPECT_EQ(update.crumbs[k].nodes, reference.crumbs[k].nodes);
            EXPECT_EQ(update.crumbs[k].component, reference.crumbs[k].component);
            EXPECT_NEAR(update.crumbs[k].volume, reference.crumbs[k].volume, 1e-12 * reference.crumbs[k].volume);
        }

        // Values of order one, sums of some dozens of terms; rotations are found to the root of rounding cubed.
        const double product_rounding = is_double ? 1e-9 : 1e-4;
        std::vector<Point> z(rebuilt.body().nodes()), product(z.size()), expected(z.size());
        std::uniform_real_distribution<double> unit(-1, 1);
        for (Point& value : z) value = {unit(random), unit(random), unit(random)};
        set_motion(changed, rebuilt);
        set_motion(rebuilt, changed);
        changed.body().apply_matrix(*scheduler, z, product);
        rebuilt.body().apply_matrix(*scheduler, z, expected);
        EXPECT_LE(largest_difference(product, expected), product_rounding * largest(expected));

        for (int step = 0; step < 3; ++step) {
            EXPECT_FALSE(changed.step(*scheduler).lost);
            EXPECT_FALSE(rebuilt.step(*scheduler).lost);
        }
        // Velocities of some decimetres a second, solved to the tolerances above.
        EXPECT_LE(largest_difference(positions(changed.body()), positions(rebuilt.body())), is_double ? 1e-8 : 1e-4);
    }
    EXPECT_GT(in_place + anew, 8);
    if (falls_back) {
        EXPECT_EQ(in_place, 0);
    } else if (of.fronts == mesh::Fronts::sharp) {
        EXPECT_EQ(anew, 0);
    } else {
        // A front that moves on takes up room around where it was as well.
        EXPECT_GT(in_place, 4 * anew);
    }
}

// Small pieces are walked through in one go: what the last front has found is no piece that came off.
class ChangedComponents : public ::testing::TestWithParam<mesh::Fronts> {};

TEST_P(ChangedComponents, AreThoseOfABodyLaidOutAnewHoweverSmallThePieces) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    for (const unsigned seed : {1U, 2U, 3U, 4U}) {
        runtime::Scene scene;
        scene.mesh = mesh::box({.cells = {2, 2, 2}, .size = {0.2, 0.2, 0.2}});
        const Settings settings{.scalar = ScalarMode::double_precision};
        CuttableBody changed(scene, settings, *scheduler, {.fronts = GetParam(), .largest_crumb = 1, .room = 1});
        CuttableBody rebuilt(scene, settings, *scheduler, {.fronts = GetParam(), .largest_crumb = 1, .room = 0});
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> unit(-1, 1);
        const auto vector = [&](double size) {
            return Point{size * unit(random), size * unit(random), size * unit(random)};
        };
        std::size_t most = 0;
        for (int round = 0; round < 20; ++round) {
            SCOPED_TRACE("seed " + std::to_string(seed) + ", cut " + std::to_string(round));
            Point corner{0.1, 0.1, 0.1};
            const Point first = vector(0.2), second = vector(0.2), shift = vector(0.1);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                corner[axis] += shift[axis] - 0.5 * (first[axis] + second[axis]);
            }
            const CutSurface surface = CutSurface::parallelogram(corner, first, second);
            const runtime::CutUpdate update = changed.cut(*scheduler, surface, runtime::Configuration::rest),
                                     reference = rebuilt.cut(*scheduler, surface, runtime::Configuration::rest);
            ASSERT_EQ(update.crumbs.size(), reference.crumbs.size());
            for (std::size_t k = 0; k < update.crumbs.size(); ++k) {
                EXPECT_EQ(update.crumbs[k].nodes, reference.crumbs[k].nodes);
                EXPECT_EQ(update.crumbs[k].component, reference.crumbs[k].component);
            }
            most = std::max(most, update.crumbs.size());
        }
        EXPECT_GT(most, 1U) << "nothing came off";
    }
}

INSTANTIATE_TEST_SUITE_P(Fronts, ChangedComponents, ::testing::Values(mesh::Fronts::sharp, mesh::Fronts::blended),
                         [](const auto& of) { return of.param == mesh::Fronts::sharp ? "sharp" : "blended"; });

INSTANTIATE_TEST_SUITE_P(Bodies, ChangedBody, ::testing::ValuesIn(cases()), [](const auto& of) {
    std::string name = of.param.name;
    std::ranges::replace(name, '-', '_');
    return name;
});

}  // namespace
}  // namespace lancet::test
