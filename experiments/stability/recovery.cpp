// Bodies that have lost their shape, held at one end and without gravity: they find back to rest, or not.

#include <algorithm>
#include <cmath>

#include "lancet/experiments/stability/bodies.hpp"
#include "lancet/experiments/stability/judges.hpp"
#include "lancet/experiments/stability/settings.hpp"
#include "lancet/experiments/stability/subjects.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"

namespace lancet::experiments::stability {

namespace {

using mesh::Point;
using runtime::ElementModel;
using runtime::MassKind;
using runtime::OperatorKind;
using runtime::ScalarMode;

constexpr double length = 1;
constexpr double step_seconds = 0.04;
/// Implicit Euler damps a mode of angular frequency w by 1 / sqrt(1 + (w h)^2) a step. The slowest one of the bar, in
/// bending, has w = 3.516 / l^2 sqrt(E I / (rho A)) = 18 / s; where a cut leaves it a third of its height, some 5 / s,
/// which is damped by 0.98, or 1e-8 in 1000 steps.
constexpr int most_steps = 1000;
/// Of the length: a few digits less than what damping and the rounding of float strains leave.
constexpr double tolerance = 1e-4;

/// A bar, half cut through at random, held at its lower end.
runtime::Scene bar(mesh::Fronts fronts, Random& random) {
    runtime::Scene scene;
    scene.mesh = mesh::box({.cells = {6, 2, 2},
                            .size = {length, length / 3, length / 3},
                            .split = random.chance(0.5) ? mesh::Split::five : mesh::Split::six});
    scene.materials[0] = {.young_modulus = 3e6, .poisson_ratio = random.uniform(0, 0.45), .density = 1000};
    scene.fixed_nodes = nodes_at_end(scene.mesh, false);
    scene.gravity = {0, 0, 0};
    mesh::CutMesh cut(scene.mesh);
    const double height = length * random.uniform(0.3, 0.8);
    cut.cut(mesh::CutSurface::half_plane({height, 0, length * random.uniform(0.1, 0.25)},
                                         {1, random.uniform(-0.5, 0.5), 0}, {0, 0, -1}));
    return divided(scene, cut, fronts);
}

std::vector<Point> lost_shape(const std::string& detail, std::span<const Point> rest, Random& random) {
    std::vector<Point> positions(rest.begin(), rest.end());
    const std::size_t axis = random.below(3);
    const Point centre{random.uniform(0, length), random.uniform(0, length), random.uniform(0, length)};
    for (Point& p : positions) {
        if (detail == "flattened") p[axis] = centre[axis];
        if (detail == "collapsed") p = centre;
        if (detail == "reflected") p[axis] = 2 * centre[axis] - p[axis];
        if (detail == "scattered") {
            for (double& x : p) x = random.uniform(0, length);
        }
    }
    return positions;
}

Verdict run(const Variant& variant, std::uint64_t seed, runtime::Scheduler& scheduler) {
    Verdict verdict;
    Random random(seed);
    const runtime::Scene scene = bar(variant.fronts, random);
    runtime::Settings settings = settings_of(variant, scene, scheduler, step_seconds);
    settings.conjugate_gradients = {.iterations = 200, .tolerance = 1e-4};
    const auto body = make_body(scene, settings, scheduler);
    body->set_positions(lost_shape(variant.detail, scene.mesh.nodes(), random));
    const MotionBound bound = motion_bound(scene, settings);
    double found = HUGE_VAL;
    int steps = 0;
    while (steps < most_steps && verdict.survived) {
        judge_motion(*body, scheduler, bound, 50, verdict);
        steps += 50;
        found = largest_distance(positions_of(*body), scene.mesh.nodes()) / length;
        if (found <= tolerance / 10) break;
    }
    verdict.error = found;
    verdict.body = std::to_string(scene.mesh.tetrahedra().size()) + " parts, Poisson's ratio " +
                   number(scene.materials.at(0).poisson_ratio) + ", " + std::to_string(steps) + " steps";
    if (!(found <= tolerance)) verdict.fail("it rests " + number(found) + " of its length from where it should");
    return verdict;
}

}  // namespace

Category recovery() {
    Category category{
        .name = "recovery",
        .criterion =
            "A bar cut half through, held at one end, without gravity, all of whose free nodes have been laid in a "
            "plane, put in one point, reflected, or scattered over its size: implicit steps of 40 ms, at most 1000, "
            "bring it back to rest within 1e-4 of its length (its slowest mode is damped to 1e-8 by then), and never "
            "add energy. St. Venant-Kirchhoff is not promised: its energy does not see reflections, which are rest "
            "states of it, and it does not resist collapse.",
        .variants = {},
        .cases = 1152,
        .quick_cases = 16,
        .run = run};
    for (const std::string detail : {"flattened", "collapsed", "reflected", "scattered"}) {
        for (const ElementModel model :
             {ElementModel::corotational, ElementModel::linear, ElementModel::st_venant_kirchhoff}) {
            for (const ScalarMode scalar : {ScalarMode::single_precision, ScalarMode::double_precision}) {
                for (const OperatorKind matrix :
                     {OperatorKind::edge_blocks, OperatorKind::block_rows, OperatorKind::matrix_free}) {
                    for (const MassKind mass : {MassKind::lumped, MassKind::fraction}) {
                        category.variants.push_back({.detail = detail,
                                                     .mass = mass,
                                                     .model = model,
                                                     .scalar = scalar,
                                                     .matrix = matrix,
                                                     .is_promised = model != ElementModel::st_venant_kirchhoff});
                    }
                }
            }
        }
    }
    category.variants = with_both_fronts(category.variants);
    return category;
}

}  // namespace lancet::experiments::stability
