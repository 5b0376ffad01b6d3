#include "lancet/experiments/stability/judges.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lancet/experiments/common/table.hpp"
#include "lancet/experiments/stability/bodies.hpp"

namespace lancet::experiments::stability {

using mesh::Point;

double epsilon_of(runtime::ScalarMode scalar) {
    return scalar == runtime::ScalarMode::double_precision ? std::numeric_limits<double>::epsilon()
                                                           : std::numeric_limits<float>::epsilon();
}

std::string number(double value) {
    return format_number(value, 3);
}

void judge_cut(const mesh::CutMesh& cut, Verdict& verdict) {
    const std::span<const mesh::Tetrahedron> elements = cut.mesh().tetrahedra();
    std::vector<double> fraction(elements.size(), 0.0);
    std::vector<int> uses(cut.node_of_copy().size(), 0);
    for (std::size_t p = 0; p < cut.parts().size(); ++p) {
        const auto part = static_cast<std::int32_t>(p);
        const auto element = static_cast<std::size_t>(cut.element_of_part()[p]);
        const double size = cut.moments(part).fraction;
        if (!(size >= 0)) verdict.fail("part " + std::to_string(p) + " has the fraction " + number(size));
        fraction[element] += size;
        for (std::size_t k = 0; k < 4; ++k) {
            const auto copy = static_cast<std::size_t>(cut.parts()[p][k]);
            if (copy >= uses.size() || cut.node_of_copy()[copy] != elements[element][k]) {
                verdict.fail("part " + std::to_string(p) + " has a copy of another node at its corner");
                return;
            }
            ++uses[copy];
        }
    }
    for (std::size_t e = 0; e < fraction.size(); ++e) {
        const double missing = std::abs(fraction[e] - 1);
        if (!(missing <= 0x1p-45)) {
            verdict.fail("the parts of element " + std::to_string(e) + " miss its volume by " + number(missing));
        }
    }
    if (std::ranges::find(uses, 0) != uses.end()) verdict.fail("a copy without a part");
}

double thinnest_part(const mesh::CutMesh& cut) {
    double thinnest = 1;
    for (std::size_t p = 0; p < cut.parts().size(); ++p) {
        thinnest = std::min(thinnest, cut.moments(static_cast<std::int32_t>(p)).fraction);
    }
    return thinnest;
}

namespace {

/// How an element's strain is rounded, and what that does.
struct StrainRounding {
    double strain, modulus, volume, height;
};

template <class Visit>
void for_each_rounding(const runtime::Scene& scene, runtime::ScalarMode scalar, const Visit& visit) {
    const mesh::TetMesh& mesh = scene.mesh;
    const double epsilon = epsilon_of(scalar);
    double farthest = 0;
    for (const Point& corner : mesh.bounds()) {
        farthest = std::max(farthest, std::hypot(corner[0], corner[1], corner[2]));
    }
    for (std::size_t e = 0; e < mesh.tetrahedra().size(); ++e) {
        const auto element = static_cast<std::int32_t>(e);
        const auto found = scene.materials.find(mesh.regions()[e]);
        const auto material =
            elastic_parameters(found == scene.materials.end() ? scene.materials.at(0) : found->second);
        const double volume = mesh.volume(element), slope = height_over_edge(mesh, element);
        // The longest edge from the quality, 6 sqrt(2) V / l^3.
        const double edge = std::cbrt(6 * std::sqrt(2.0) * volume / quality(mesh, element));
        visit(StrainRounding{.strain = 8 * (epsilon + std::numeric_limits<double>::epsilon() * farthest / edge) / slope,
                             .modulus = 2 * material.mu + 3 * std::abs(material.lambda),
                             .volume = volume * scene.parts.of(e).fraction,
                             .height = slope * edge});
    }
}

}  // namespace

double rounding_energy(const runtime::Scene& scene, runtime::ScalarMode scalar) {
    double energy = 0;
    for_each_rounding(scene, scalar, [&](const StrainRounding& of) {
        energy += 0.5 * of.modulus * of.strain * of.strain * of.volume;
    });
    return energy;
}

double rounding_force(const runtime::Scene& scene, runtime::ScalarMode scalar) {
    double largest = 0;
    for_each_rounding(scene, scalar, [&](const StrainRounding& of) {
        largest = std::max(largest, of.modulus * of.strain * of.volume / of.height);
    });
    return largest;
}

MotionBound motion_bound(const runtime::Scene& scene, const runtime::Settings& settings) {
    MotionBound bound;
    bound.is_explicit = is_explicit(settings.integrator);
    bound.epsilon = epsilon_of(settings.scalar);
    constexpr double theta = 0.95;
    if (bound.is_explicit) {
        bound.rounding_energy = rounding_energy(scene, settings.scalar);
        if (settings.model != runtime::ElementModel::linear) bound.share_of_work = theta * theta / (1 - theta * theta);
    }
    double mass = 0, farthest = 0;
    for (std::size_t e = 0; e < scene.mesh.tetrahedra().size(); ++e) {
        const auto found = scene.materials.find(scene.mesh.regions()[e]);
        const double density = (found == scene.materials.end() ? scene.materials.at(0) : found->second).density;
        mass += density * scene.mesh.volume(static_cast<std::int32_t>(e)) * scene.parts.of(e).fraction;
    }
    for (const Point& corner : scene.mesh.bounds()) {
        farthest = std::max(farthest, std::hypot(corner[0], corner[1], corner[2]));
    }
    const double gravity = std::hypot(scene.gravity[0], scene.gravity[1], scene.gravity[2]);
    bound.gravity_rounding = 4 * std::numeric_limits<double>::epsilon() * mass * gravity * farthest;
    return bound;
}

bool is_finite(std::span<const Point> points) {
    return std::ranges::all_of(points, [](const Point& p) { return std::isfinite(p[0] + p[1] + p[2]); });
}

std::vector<Point> positions_of(const runtime::DeformableBody& body) {
    std::vector<Point> points(body.nodes());
    body.positions(points);
    return points;
}

double largest_distance(std::span<const Point> found, std::span<const Point> expected) {
    double largest = 0;
    for (std::size_t n = 0; n < found.size(); ++n) {
        largest = std::max(largest, std::hypot(found[n][0] - expected[n][0], found[n][1] - expected[n][1],
                                               found[n][2] - expected[n][2]));
    }
    return largest;
}

void judge_motion(runtime::DeformableBody& body, runtime::Scheduler& scheduler, const MotionBound& bound, int steps,
                  Verdict& verdict) {
    const runtime::Energies start = body.energies(scheduler);
    double before = start.kinetic + start.elastic;
    double rounding = 0, most_work = before, largest_energy = before;
    double most_iterations = 0, worst_excess = -HUGE_VAL;
    int repeats = 0;
    for (int step = 1; step <= steps; ++step) {
        const runtime::StepReport report = body.step(scheduler);
        const std::string when = "step " + std::to_string(step) + ": ";
        most_iterations = std::max(most_iterations, static_cast<double>(report.conjugate_gradient_iterations));
        repeats += report.repeated ? 1 : 0;
        if (report.lost) verdict.fail(when + "the state was lost");
        const runtime::Energies now = body.energies(scheduler);
        const double energy = now.kinetic + now.elastic;
        if (!std::isfinite(energy) || !std::isfinite(now.gravity)) {
            verdict.fail(when + "the energy is not finite");
            break;
        }
        // What the loads have put in, and what was there.
        const double work = start.total() - now.gravity;
        most_work = std::max(most_work, work);
        largest_energy = std::max(largest_energy, energy);
        rounding += 128 * bound.epsilon * (before + energy) + bound.gravity_rounding;
        double allowed = work + rounding;
        // Explicit: of each step; implicit: of the energy at the start.
        const double root = 2.0 * (bound.is_explicit ? step : 1) * std::sqrt(bound.rounding_energy);
        allowed += bound.share_of_work * most_work + root * (2 * std::sqrt(largest_energy) + root);
        const double scale = std::max({energy, std::abs(work), std::numeric_limits<double>::min()});
        worst_excess = std::max(worst_excess, (energy - work) / scale);
        if (energy > allowed) {
            verdict.fail(when + "energy " + number(energy) + " J, allowed " + number(allowed) + " J for work " +
                         number(work) + " J");
        }
        before = energy;
        if (!verdict.survived) break;
    }
    std::vector<Point> velocities(body.nodes());
    body.velocities(velocities);
    if (!is_finite(positions_of(body)) || !is_finite(velocities)) verdict.fail("positions or velocities not finite");
    if (!bound.is_explicit) {
        verdict.iterations = std::max(verdict.iterations.value_or(0), most_iterations);
        verdict.repeats = static_cast<double>(repeats) / steps;
    }
    verdict.energy_excess = std::max(verdict.energy_excess.value_or(-HUGE_VAL), worst_excess);
}

}  // namespace lancet::experiments::stability
