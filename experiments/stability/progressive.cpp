// Random cuts of random bodies while they move: in place as long as there is room, a step or some between cuts.

#include <algorithm>
#include <cmath>
#include <sstream>

#include "lancet/experiments/stability/bodies.hpp"
#include "lancet/experiments/stability/judges.hpp"
#include "lancet/experiments/stability/settings.hpp"
#include "lancet/experiments/stability/subjects.hpp"
#include "lancet/experiments/stability/surfaces.hpp"
#include "lancet/kernels/layout/element_batches.hpp"
#include "lancet/runtime/cut/cuttable_body.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"

namespace lancet::experiments::stability {

namespace {

using mesh::Point;

/// Lanes of smaller fractions than 1e-20 are taken as 1e-20: where there are some, energies do not add up.
constexpr double thin = 1e-19;

/// What a cut must keep.
struct Kept {
    double mass = 0;
    Point momentum{};
    double momentum_scale = 0;  ///< sum of m |v|
    double elastic = 0, kinetic = 0;
    double thinnest = 1;  ///< fraction of its element that a part is
};

Kept kept_by(runtime::CuttableBody& cuttable, runtime::Scheduler& scheduler) {
    runtime::DeformableBody& body = cuttable.body();
    Kept kept{.thinnest = thinnest_part(cuttable.mesh())};
    std::vector<Point> velocities(body.nodes());
    body.velocities(velocities);
    for (std::size_t node = 0; node < velocities.size(); ++node) {
        const double mass = body.nodal_mass(static_cast<std::int32_t>(node));
        const Point& v = velocities[node];
        kept.mass += mass;
        kept.momentum_scale += mass * std::hypot(v[0], v[1], v[2]);
        for (std::size_t axis = 0; axis < 3; ++axis) kept.momentum[axis] += mass * v[axis];
    }
    const runtime::Energies energies = body.energies(scheduler);
    kept.elastic = energies.elastic;
    kept.kinetic = energies.kinetic;
    return kept;
}

/// The largest |F| (Frobenius) of a part.
double largest_deformation(const runtime::CuttableBody& body) {
    const mesh::CutMesh& cut = body.mesh();
    const std::vector<Point> positions = positions_of(body.body());
    double largest = 0;
    for (std::size_t part = 0; part < cut.parts().size(); ++part) {
        const auto& rest = cut.mesh().tetrahedra()[static_cast<std::size_t>(cut.element_of_part()[part])];
        const auto geometry = kernels::tetrahedron_geometry(cut.mesh().nodes(), rest);
        const Point& origin = positions[static_cast<std::size_t>(cut.parts()[part][0])];
        std::array<Point, 3> f{};
        for (std::size_t k = 1; k < 4; ++k) {
            const Point& at = positions[static_cast<std::size_t>(cut.parts()[part][k])];
            for (std::size_t i = 0; i < 3; ++i) {
                for (std::size_t j = 0; j < 3; ++j) f[i][j] += (at[i] - origin[i]) * geometry.gradients[k][j];
            }
        }
        double square = 0;
        for (const Point& row : f) square += row[0] * row[0] + row[1] * row[1] + row[2] * row[2];
        largest = std::max(largest, std::sqrt(square));
    }
    return largest;
}

void judge_kept(const Kept& before, const Kept& after, const Variant& variant, double strain_rounding,
                const std::string& when, Verdict& verdict) {
    if (!(std::abs(after.mass / before.mass - 1) <= 1e-12)) {
        verdict.fail(when + "the mass changed by " + number(after.mass / before.mass - 1));
    }
    // The fraction of a thin part has a relative precision of 2^-30.
    const double thinnest = std::min(before.thinnest, after.thinnest);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double change = std::abs(after.momentum[axis] - before.momentum[axis]);
        if (!(change <= (thinnest < 1e-6 ? 0x1p-28 : 1e-11) * before.momentum_scale)) {
            verdict.fail(when + "the momentum changed by " + number(change / before.momentum_scale));
        }
    }
    // A blended front that moves on gives other weights to what is open and what is closed, and thinner parts are taken
    // for thicker.
    if (variant.fronts == mesh::Fronts::blended || thinnest < thin) return;
    // The same strains, rounded anew: by dF of the energy E_r each, so that E changes by 2 sqrt(E E_r) + E_r at most,
    // and sums in the elements' scalar over other lanes.
    const double root = std::sqrt(strain_rounding);
    const double rounding = 128 * epsilon_of(variant.scalar) + (thinnest < 1e-6 ? 0x1p-28 : 0);
    const double energy = before.elastic + after.elastic;
    const double allowed = rounding * energy + 2 * root * (2 * std::sqrt(energy) + root);
    if (!(std::abs(after.elastic - before.elastic) <= allowed)) {
        verdict.fail(when + "the elastic energy of " + number(before.elastic) + " J changed by " +
                     number(after.elastic - before.elastic) + " J, allowed " + number(allowed) + " J");
    }
    if (!(std::abs(after.kinetic - before.kinetic) <= rounding * (before.kinetic + after.kinetic))) {
        verdict.fail(when + "the kinetic energy went from " + number(before.kinetic) + " to " + number(after.kinetic) +
                     " J");
    }
}

/// The forces of a linear body, which has no memory, are those of one that is laid out anew.
void judge_forces(runtime::CuttableBody& body, const runtime::Scene& scene, const Variant& variant,
                  const runtime::Settings& settings, runtime::Scheduler& scheduler, Verdict& verdict) {
    const auto anew = make_body(divided(scene, body.mesh(), variant.fronts), settings, scheduler);
    if (anew->nodes() != body.body().nodes()) {
        verdict.fail("the body has " + number(static_cast<double>(body.body().nodes())) + " nodes, laid out anew " +
                     number(static_cast<double>(anew->nodes())));
        return;
    }
    anew->set_positions(positions_of(body.body()));
    std::vector<Point> found(anew->nodes()), expected(anew->nodes());
    body.body().elastic_forces(scheduler, found);
    anew->elastic_forces(scheduler, expected);
    double largest = 0;
    for (const Point& force : expected)
        largest = std::max({largest, std::abs(force[0]), std::abs(force[1]), std::abs(force[2])});
    // Sums of up to some hundreds of lanes in another order, each rounded once, of strains that are rounded alike but
    // for those of the lanes of one element, which were of one lane: some dozens at a node.
    const double difference = largest_distance(found, expected), longer = std::max(1.0, largest_deformation(body));
    const double allowed =
        512 * epsilon_of(variant.scalar) * largest + 64 * longer * rounding_force(scene, variant.scalar);
    if (!(difference <= allowed)) {
        verdict.fail("a force differs by " + number(difference / largest) + " from that of a body laid out anew");
    }
    verdict.error = std::max(verdict.error.value_or(0), largest > 0 ? difference / largest : 0);
}

Verdict run(const Variant& variant, std::uint64_t seed, runtime::Scheduler& scheduler) {
    constexpr std::size_t most_parts = 2000;
    Verdict verdict;
    Random random(seed);
    const runtime::Scene scene = random_scene(random_mesh(random), random);
    runtime::Settings settings = settings_of(variant, scene, scheduler, random.logarithmic(1e-3, 0.1));
    if (random.chance(0.5)) settings.conjugate_gradients = {.iterations = 300, .tolerance = 1e-5};
    // Aggregates and blocks that cuts sever and fill, also of bodies as small as these.
    if (random.chance(0.5)) settings.numbering = {.nodes_per_block = 32, .nodes_per_aggregate = 8};
    MotionBound bound = motion_bound(scene, settings);
    // What a motion between two cuts begins with is measured after rotations have been found anew.
    const double strain_rounding = rounding_energy(scene, variant.scalar);
    bound.rounding_energy = strain_rounding;
    runtime::CuttableBody body(scene, settings, scheduler,
                               {.fronts = variant.fronts, .room = random.chance(0.5) ? 1 : 0.05});
    const int cuts = random.between(4, 12);
    int in_place = 0, anew = 0;
    for (int k = 0; k < cuts && verdict.survived && body.mesh().parts().size() < most_parts; ++k) {
        judge_motion(body.body(), scheduler, bound, random.between(1, 12), verdict);
        if (!verdict.survived) break;
        const std::string when = "cut " + std::to_string(k + 1) + ": ";
        const bool is_current = random.chance(0.5);
        std::vector<Point> positions = is_current ? positions_of(body.body()) : body.mesh().rest_positions();
        positions.resize(body.mesh().node_of_copy().size());
        const auto part = static_cast<std::int32_t>(random.below(body.mesh().parts().size()));
        const Kept before = kept_by(body, scheduler);
        // F is a sum over edges, which may be longer than at rest, and a strain (F^T F - 1) / 2 a product of two.
        const double longer = std::max(1.0, largest_deformation(body));
        const double amplified = variant.model == runtime::ElementModel::st_venant_kirchhoff ? longer * longer : longer;
        const auto update = body.cut(scheduler, random_surface(body.mesh(), part, positions, random),
                                     is_current ? runtime::Configuration::current : runtime::Configuration::rest,
                                     random.chance(0.5) ? mesh::FrontTreatment::retract : mesh::FrontTreatment::extend);
        if (update.mesh.new_parts > 0 || update.mesh.new_copies > 0) ++(update.rebuilt ? anew : in_place);
        judge_cut(body.mesh(), verdict);
        judge_kept(before, kept_by(body, scheduler), variant, strain_rounding * amplified * amplified, when, verdict);
    }
    if (verdict.survived) judge_motion(body.body(), scheduler, bound, 50, verdict);
    if (verdict.survived && variant.model == runtime::ElementModel::linear && thinnest_part(body.mesh()) >= thin) {
        judge_forces(body, scene, variant, settings, scheduler, verdict);
    }
    std::ostringstream text;
    text << scene.mesh.tetrahedra().size() << " elements, " << body.mesh().parts().size() << " parts, " << in_place
         << " cuts in place, " << anew << " laid out anew, the thinnest part " << number(thinnest_part(body.mesh()))
         << ", step " << number(1000 * settings.time_step) << " ms";
    verdict.body = text.str();
    return verdict;
}

/// What changes in place: implicit motion by products of elements or of edges.
std::vector<Variant> variants() {
    std::vector<Variant> chosen;
    for (const Variant& variant : all_dynamics()) {
        if (variant.is_explicit() || variant.matrix == runtime::OperatorKind::block_rows) continue;
        chosen.push_back(variant);
    }
    return with_both_fronts(chosen);
}

}  // namespace

Category progressive() {
    return {
        .name = "progressive",
        .criterion =
            "Four to twelve random cuts of a body that moves, 1 to 12 steps between them and 50 after, in place as "
            "long as there is room: parts are not negative and add up to their elements within 2^-45; a cut "
            "keeps mass within 1e-12 and momentum within 1e-11, or 2^-28 where a part is thinner than 1e-6. With sharp "
            "fronts, and no part below 1e-19, it keeps kinetic energy within 128 eps and elastic energy within that "
            "and rounded strains. The motion between cuts: finite, and the energy is at most what was there and the "
            "loads have put in, plus 128 eps of it a step, and rounded strains of its start. Forces of linear bodies "
            "are those of the body laid out anew, within 512 eps and the rounding of some dozens of strains.",
        .variants = variants(),
        .cases = 2000,
        .quick_cases = 80,
        .run = run};
}

}  // namespace lancet::experiments::stability
