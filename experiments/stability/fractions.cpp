// A cube held at both ends, with a cut so near to a layer of nodes, or to one node, that a given fraction of an element
// is cut off: the iteration counts of the problem without slivers, and thin copies that are as right as the others.

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

using mesh::CutMesh;
using mesh::Point;
using runtime::ElementModel;
using runtime::MassKind;
using runtime::OperatorKind;
using runtime::PreconditionerKind;
using runtime::ScalarMode;

runtime::Scene cube(Random& random) {
    runtime::Scene scene;
    scene.mesh = mesh::box({.cells = {4, 4, 4}, .split = random.chance(0.5) ? mesh::Split::five : mesh::Split::six});
    scene.materials[0] = {.young_modulus = 1e5, .poisson_ratio = 0.33, .density = 1000};
    // Askew: conjugate gradients on a mirrored body under a mirrored load meet one class of its modes alone, and need
    // half of the iterations, which no cut that is not mirrored leaves them.
    const auto down = random.direction();
    for (std::size_t axis = 0; axis < 3; ++axis) scene.gravity[axis] = 9.81 * down[axis];
    for (const bool highest : {false, true}) {
        for (const std::int32_t node : nodes_at_end(scene.mesh, highest)) scene.fixed_nodes.push_back(node);
    }
    return scene;
}

/// Where the cube is cut: in two, along the layer of nodes in its middle, or by a tilted square inside, close to the
/// node in the middle.
struct Blade {
    bool is_through = true;
    Point normal{1, 0, 0};

    explicit Blade(Random& random) : is_through(random.chance(0.5)) {
        if (!is_through) normal = {1, random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3)};
    }
    /// The surface at a distance, in units of the normal, from the node in the middle.
    mesh::CutSurface at(double distance) const {
        const Point centre{0.5 + distance * normal[0], 0.5 + distance * normal[1], 0.5 + distance * normal[2]};
        if (is_through) return mesh::CutSurface::plane(centre, normal);
        // Edges in the plane, along y and z but for the tilt; the square ends 0.35 from the middle.
        const Point first{-0.7 * normal[1], 0.7, 0}, second{-0.7 * normal[2], 0, 0.7};
        return mesh::CutSurface::parallelogram(
            {centre[0] - (first[0] + second[0]) / 2, centre[1] - 0.35, centre[2] - 0.35}, first, second);
    }
};

CutMesh cut_at(const runtime::Scene& scene, const Blade& blade, double distance) {
    CutMesh cut(scene.mesh);
    cut.cut(blade.at(distance));
    return cut;
}

/// Cut so that the thinnest part has the wanted fraction, within the rounding of the distance. A corner that is cut off
/// grows with the cube of the distance, so a few corrections find it.
CutMesh cut_with_fraction(const runtime::Scene& scene, double fraction, const Blade& blade) {
    double distance = 0.25 * std::cbrt(fraction);
    for (int k = 0; k < 6; ++k) {
        const double found = thinnest_part(cut_at(scene, blade, distance));
        if (std::abs(found / fraction - 1) < 1e-3) break;
        distance *= std::cbrt(fraction / found);
    }
    return cut_at(scene, blade, distance);
}

/// The same problem without slivers: cut in two along faces, or not at all.
runtime::Scene without_slivers(const runtime::Scene& scene, const Blade& blade) {
    return blade.is_through ? divided(scene, cut_at(scene, blade, 0)) : scene;
}

/// Copies all whose parts together are less than a tenth of an element.
std::vector<bool> thin_copies(const runtime::Scene& parts) {
    std::vector<double> share(parts.mesh.nodes().size(), 0.0);
    for (std::size_t e = 0; e < parts.mesh.tetrahedra().size(); ++e) {
        for (const std::int32_t copy : parts.mesh.tetrahedra()[e]) {
            share[static_cast<std::size_t>(copy)] += parts.parts.of(e).fraction;
        }
    }
    std::vector<bool> thin;
    for (const double value : share) thin.push_back(value < 0.1);
    return thin;
}

struct Solution {
    std::vector<Point> displacements;
    double iterations = 0;
    std::string complaint{};
};

Solution statics(const runtime::Scene& scene, const Variant& variant, double tolerance, runtime::Scheduler& scheduler) {
    runtime::EquilibriumSettings settings = equilibrium_settings_of(variant);
    settings.tolerance = tolerance;
    Solution solution;
    std::vector<Point> positions(scene.mesh.nodes().begin(), scene.mesh.nodes().end());
    const auto report = find_equilibrium(scene, settings, scheduler, positions);
    if (report.end != runtime::EquilibriumEnd::converged) solution.complaint = report.explanation;
    solution.iterations = report.conjugate_gradient_iterations;
    solution.displacements = positions;
    return solution;
}

/// One step from rest.
Solution step(const runtime::Scene& scene, const Variant& variant, double tolerance, runtime::Scheduler& scheduler) {
    runtime::Settings settings = settings_of(variant, scene, scheduler, 0.04);
    settings.conjugate_gradients = {.iterations = 5000, .tolerance = tolerance};
    const auto body = make_body(scene, settings, scheduler);
    const runtime::StepReport report = body->step(scheduler);
    Solution solution;
    if (report.lost || report.repeated) solution.complaint = "the step was lost or repeated";
    if (!(report.conjugate_gradient_residual <= tolerance)) {
        solution.complaint = "conjugate gradients ended at " + number(report.conjugate_gradient_residual);
    }
    solution.iterations = report.conjugate_gradient_iterations;
    solution.displacements = positions_of(*body);
    return solution;
}

Verdict run(const Variant& variant, std::uint64_t seed, runtime::Scheduler& scheduler) {
    Verdict verdict;
    Random random(seed);
    const runtime::Scene scene = cube(random);
    const Blade blade(random);
    const CutMesh cut = cut_with_fraction(scene, variant.number, blade);
    judge_cut(cut, verdict);
    const runtime::Scene parts = divided(scene, cut, variant.fronts);
    verdict.body =
        std::string(blade.is_through ? "cut in two" : "cut inside") + ", thinnest part " + number(thinnest_part(cut));

    const bool is_static = variant.detail.ends_with("static");
    const auto solve = is_static ? statics : step;
    const double tolerance = variant.scalar == ScalarMode::double_precision ? 1e-8 : 1e-4;
    const Solution plain = solve(without_slivers(scene, blade), variant, tolerance, scheduler);
    const Solution found = solve(parts, variant, tolerance, scheduler);
    Variant exact = variant;
    exact.scalar = ScalarMode::double_precision;
    const Solution reference = solve(parts, exact, 1e-12, scheduler);
    verdict.iterations = found.iterations;
    verdict.iteration_ratio = found.iterations / plain.iterations;
    if (!found.complaint.empty()) verdict.fail(found.complaint);
    if (!is_finite(found.displacements)) verdict.fail("positions are not finite");
    if (*verdict.iteration_ratio > 1.5) {
        verdict.fail(number(found.iterations) + " iterations; " + number(plain.iterations) + " without slivers");
    }

    const std::vector<bool> thin = thin_copies(parts);
    double scale = 0, error = 0, thin_error = 0;
    for (std::size_t n = 0; n < thin.size(); ++n) {
        const Point &rest = parts.mesh.nodes()[n], &right = reference.displacements[n], &is = found.displacements[n];
        scale = std::max(scale, std::hypot(right[0] - rest[0], right[1] - rest[1], right[2] - rest[2]));
        const double distance = std::hypot(is[0] - right[0], is[1] - right[1], is[2] - right[2]);
        (thin[n] ? thin_error : error) = std::max(thin[n] ? thin_error : error, distance);
    }
    verdict.error = thin_error / scale;
    // The reference itself ends at 1e-12 of its loads: it is right to far less than any tolerance here, or says so.
    const double allowed = std::max(1.5 * error / scale, 10 * tolerance);
    if (!(*verdict.error <= allowed)) {
        verdict.fail("thin copies are wrong by " + number(*verdict.error) + ", others by " + number(error / scale) +
                     " of the largest displacement");
    }
    return verdict;
}

}  // namespace

Category fractions() {
    Category category{
        .name = "fractions",
        .criterion =
            "A cube held at both ends, cut in two or by a square inside, so near to nodes that the thinnest part is "
            "the "
            "given fraction of its element: the equilibrium and the first step of 40 ms end at the tolerance of 1e-4 "
            "(float) or 1e-8 (double), after at most 1.5 times the iterations of the same problem without slivers "
            "(uncut, or cut in two along faces: that itself takes up to twice the iterations of the uncut cube, at any "
            "fraction); and copies that carry less than a tenth of an element are off a solution in double to 1e-12 by "
            "at most 10 times the tolerance, of the largest displacement, or 1.5 times what the other copies are off.",
        .variants = {},
        .run = run};
    for (const int exponent : {-2, -4, -6, -8, -10, -12, -14}) {
        for (const bool is_static : {true, false}) {
            for (const ElementModel model : {ElementModel::corotational, ElementModel::linear}) {
                for (const ScalarMode scalar : {ScalarMode::single_precision, ScalarMode::double_precision}) {
                    for (const PreconditionerKind preconditioner :
                         {PreconditionerKind::block_jacobi, PreconditionerKind::coarse}) {
                        for (const OperatorKind matrix :
                             {OperatorKind::edge_blocks, OperatorKind::block_rows, OperatorKind::matrix_free}) {
                            Variant variant{.detail = power_of_ten(exponent) + (is_static ? "-static" : "-step"),
                                            .number = std::pow(10.0, exponent),
                                            .model = model,
                                            .scalar = scalar,
                                            .matrix = matrix,
                                            .preconditioner = preconditioner};
                            category.variants.push_back(variant);
                            if (is_static) continue;
                            variant.mass = MassKind::fraction;
                            category.variants.push_back(variant);
                        }
                    }
                }
            }
        }
    }
    category.variants = with_both_fronts(category.variants);
    category.cases = static_cast<int>(category.variants.size());
    category.quick_cases = 42;
    return category;
}

std::string power_of_ten(int exponent) {
    return "1e" + std::to_string(exponent);
}

}  // namespace lancet::experiments::stability
