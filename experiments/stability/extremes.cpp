// Materials and elements near the end of what linear elements are made for: a cut body in equilibrium, in motion under
// gravity, and back to rest.

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
constexpr double rest_tolerance = 1e-4;  ///< of the length, as for bodies that have lost their shape

enum class Extreme { poisson, stiffness, quality };

/// A bar held at one end, with a cut that ends inside, and gravity across. `number` is Poisson's ratio, the ratio of
/// stiffnesses, or the quality.
runtime::Scene bar(Extreme extreme, double number, Random& random) {
    runtime::Scene scene;
    scene.mesh = mesh::box({.cells = {6, 2, 2},
                            .size = {length, length / 3, length / 3},
                            .split = random.chance(0.5) ? mesh::Split::five : mesh::Split::six});
    runtime::Material material{.young_modulus = 1e6, .poisson_ratio = 0.33, .density = 1000};
    if (extreme == Extreme::poisson) material.poisson_ratio = number;
    if (extreme == Extreme::quality) scene.mesh = with_bad_element(scene.mesh, number, random);
    scene.materials[0] = material;
    if (extreme == Extreme::stiffness) {
        // Stiff elements anywhere: next to the support, behind the cut, inclusions.
        mesh::TetMesh::Definition definition = scene.mesh.definition();
        for (int& region : definition.regions) region = random.chance(0.3) ? 1 : 0;
        scene.mesh = mesh::TetMesh(std::move(definition));
        scene.materials[1] = material;
        scene.materials[1].young_modulus *= number;
    }
    scene.fixed_nodes = nodes_at_end(scene.mesh, false);
    return scene;
}

mesh::CutMesh cut_of(const runtime::Scene& scene, Random& random) {
    mesh::CutMesh cut(scene.mesh);
    cut.cut(mesh::CutSurface::half_plane({length * random.uniform(0.3, 0.8), 0, length * random.uniform(0.1, 0.25)},
                                         {1, random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)}, {0, 0, -1}));
    return cut;
}

/// The equilibrium is found, and is that of a solution in double.
void judge_statics(const runtime::Scene& scene, const Variant& variant, runtime::Scheduler& scheduler,
                   Verdict& verdict) {
    const auto solve = [&](ScalarMode scalar, double tolerance, std::vector<Point>& positions) {
        Variant own = variant;
        own.scalar = scalar;
        runtime::EquilibriumSettings settings = equilibrium_settings_of(own);
        if (tolerance > 0) settings.tolerance = tolerance;
        settings.conjugate_gradient_iterations = 20000;
        positions.assign(scene.mesh.nodes().begin(), scene.mesh.nodes().end());
        return find_equilibrium(scene, settings, scheduler, positions);
    };
    std::vector<Point> found, reference;
    const auto report = solve(variant.scalar, 0, found);
    // As far as double goes: where rounding ends it above its tolerance, it says so, and what counts is the error.
    const auto exact = solve(ScalarMode::double_precision, 1e-12, reference);
    verdict.iterations = report.conjugate_gradient_iterations;
    if (report.load_factor < 1) verdict.fail(report.explanation);
    if (exact.load_factor < 1) verdict.fail("in double: " + exact.explanation);
    const double scale = largest_distance(reference, scene.mesh.nodes());
    verdict.error = largest_distance(found, reference) / scale;
    const double allowed = variant.scalar == ScalarMode::single_precision ? 1e-2 : 1e-6;
    if (!(*verdict.error <= allowed)) {
        verdict.fail("displacements are wrong by " + number(*verdict.error) + " of the largest; " + report.explanation);
    }
}

/// 200 steps under gravity, or back to rest from a bend.
void judge_dynamics(runtime::Scene scene, const runtime::Scene& uncut, const Variant& variant, bool to_rest,
                    runtime::Scheduler& scheduler, Verdict& verdict) {
    if (to_rest) scene.gravity = {0, 0, 0};
    runtime::Settings settings = settings_of(variant, uncut, scheduler, 0.04);
    if (!to_rest) {
        const auto body = make_body(scene, settings, scheduler);
        judge_motion(*body, scheduler, motion_bound(scene, settings), 200, verdict);
        return;
    }
    settings.conjugate_gradients = {.iterations = 2000, .tolerance = 1e-4};
    const auto body = make_body(scene, settings, scheduler);
    std::vector<Point> positions(scene.mesh.nodes().begin(), scene.mesh.nodes().end());
    for (Point& p : positions) p[1] += 0.2 * p[0] * p[0] / length;
    body->set_positions(positions);
    for (int steps = 0; steps < 1000 && verdict.survived; steps += 50) {
        judge_motion(*body, scheduler, motion_bound(scene, settings), 50, verdict);
        verdict.error = largest_distance(positions_of(*body), scene.mesh.nodes()) / length;
        if (*verdict.error <= rest_tolerance / 10) break;
    }
    if (!(*verdict.error <= rest_tolerance)) {
        verdict.fail("it rests " + number(*verdict.error) + " of its length from where it should");
    }
}

Verdict run(Extreme extreme, const Variant& variant, std::uint64_t seed, runtime::Scheduler& scheduler) {
    Verdict verdict;
    Random random(seed);
    const runtime::Scene scene = bar(extreme, variant.number, random);
    const mesh::CutMesh cut = cut_of(scene, random);
    judge_cut(cut, verdict);
    const runtime::Scene parts = divided(scene, cut);
    verdict.body =
        std::to_string(parts.mesh.tetrahedra().size()) + " parts, lowest quality " + number(lowest_quality(scene.mesh));
    if (variant.detail.ends_with("static")) {
        judge_statics(parts, variant, scheduler, verdict);
    } else {
        judge_dynamics(parts, scene, variant, variant.detail.ends_with("rest"), scheduler, verdict);
    }
    return verdict;
}

Category category_of(Extreme extreme, const std::string& name, const std::string& subject,
                     std::initializer_list<std::pair<const char*, double>> numbers) {
    Category category{
        .name = name,
        .criterion =
            "A bar held at one end, with a cut that ends inside, " + subject +
            ". static: an equilibrium under gravity is found for the full load, to 1e-4 (float) or 1e-8 "
            "(mixed, double) of the loads or as far as rounding lets it, and its displacements are within 1e-2 "
            "(float) or 1e-6 of the largest of a solution in double that goes as far as rounding lets it. "
            "fall: 200 steps of 40 ms, or explicit ones of 0.95 of a critical step, under gravity: finite, and "
            "the energy bounded as for the sequences. rest: bent by 0.2 of its length without gravity, it "
            "comes back within 1e-4 of its length in 1000 steps of 40 ms, and never gains energy. Not "
            "promised: statics all in float, whose residual ends where forces in float are rounded; rest of "
            "St. Venant-Kirchhoff, whose elements stay where they have been turned inside out; and what the "
            "sequences do not promise.",
        .variants = {},
        .run = [extreme](const Variant& variant, std::uint64_t seed, runtime::Scheduler& scheduler) {
            return run(extreme, variant, seed, scheduler);
        }};
    for (const auto& [label, number] : numbers) {
        for (const std::string what : {"static", "fall", "rest"}) {
            for (Variant variant : all_dynamics()) {
                // Statics have neither masses nor explicit steps; explicit ones come to no rest.
                if (what == "static" && (variant.is_explicit() || variant.mass == MassKind::fraction)) continue;
                if (what == "rest" && variant.is_explicit()) continue;
                variant.detail = std::string(label) + "-" + what;
                variant.number = number;
                if (what == "rest" && variant.model == ElementModel::st_venant_kirchhoff) variant.is_promised = false;
                if (what == "static" && variant.scalar == ScalarMode::single_precision) {
                    variant.is_promised = false;
                    category.variants.push_back(variant);
                    variant.scalar = ScalarMode::mixed;
                    variant.is_promised = true;
                }
                category.variants.push_back(variant);
            }
        }
    }
    category.cases = 2 * static_cast<int>(category.variants.size());
    category.quick_cases = 20;
    return category;
}

}  // namespace

Category poisson_ratios() {
    return category_of(Extreme::poisson, "poisson", "of the given Poisson's ratio",
                       {{"0.45", 0.45}, {"0.49", 0.49}, {"0.499", 0.499}, {"0.4999", 0.4999}});
}

Category stiff_parts() {
    return category_of(Extreme::stiffness, "stiffness-ratio", "of which a random third is stiffer by the given factor",
                       {{"1e2", 1e2}, {"1e4", 1e4}, {"1e6", 1e6}});
}

Category flat_elements() {
    return category_of(Extreme::quality, "quality",
                       "one of whose elements has the given quality 6 sqrt(2) V / l^3 with l its longest edge",
                       {{"1e-2", 1e-2}, {"1e-3", 1e-3}, {"1e-4", 1e-4}, {"1e-5", 1e-5}, {"1e-6", 1e-6}});
}

}  // namespace lancet::experiments::stability
