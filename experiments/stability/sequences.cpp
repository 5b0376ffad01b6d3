// Random cuts of random bodies, with either kind of fronts: through nodes, along edges and faces, one unit in the last
// place beside, at rest and where the body has moved; then 200 steps under gravity.

#include <algorithm>
#include <cmath>
#include <sstream>

#include "lancet/experiments/stability/bodies.hpp"
#include "lancet/experiments/stability/judges.hpp"
#include "lancet/experiments/stability/settings.hpp"
#include "lancet/experiments/stability/subjects.hpp"
#include "lancet/experiments/stability/surfaces.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"

namespace lancet::experiments::stability {

namespace {

using mesh::CutMesh;
using mesh::Point;

/// Places of all copies as after some motion: an affine map, and every copy a little beside.
std::vector<Point> moved_positions(const CutMesh& cut, Random& random) {
    std::vector<Point> positions = cut.rest_positions();
    std::array<Point, 3> map{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) map[i][j] = (i == j ? 1 : 0) + random.uniform(-0.3, 0.3);
    }
    double shortest = HUGE_VAL;
    for (std::size_t e = 0; e < cut.mesh().tetrahedra().size(); ++e) {
        shortest = std::min(shortest, std::cbrt(cut.mesh().volume(static_cast<std::int32_t>(e))));
    }
    for (Point& p : positions) {
        const Point at = p;
        const auto direction = random.direction();
        for (std::size_t i = 0; i < 3; ++i) {
            p[i] = map[i][0] * at[0] + map[i][1] * at[1] + map[i][2] * at[2] + 0.05 * shortest * direction[i];
        }
    }
    return positions;
}

/// One to eight cuts, about half of the sequences through one and the same element. Stops before elements have so many
/// parts that a case would be one of size.
void cut_at_random(CutMesh& cut, Random& random, Verdict& verdict) {
    constexpr std::size_t most_parts = 3000;
    const int cuts = random.between(1, 8);
    const bool has_focus = random.chance(0.5);
    const auto focus = static_cast<std::int32_t>(random.below(cut.mesh().tetrahedra().size()));
    for (int k = 0; k < cuts && verdict.survived && cut.parts().size() < most_parts; ++k) {
        const auto front = random.chance(0.5) ? mesh::FrontTreatment::retract : mesh::FrontTreatment::extend;
        const auto part = has_focus ? focus : static_cast<std::int32_t>(random.below(cut.parts().size()));
        if (random.chance(0.08)) {
            cut.cut(around_node(cut, static_cast<std::int32_t>(random.below(cut.mesh().nodes().size()))), front);
        } else if (random.chance(0.25)) {
            const std::vector<Point> positions = moved_positions(cut, random);
            cut.cut(random_surface(cut, part, positions, random), front, positions);
        } else {
            cut.cut(random_surface(cut, part, cut.rest_positions(), random), front);
        }
        judge_cut(cut, verdict);
    }
}

/// All mass is on some copy, within the rounding of a sum over the parts.
void judge_mass(const CutMesh& cut, const runtime::Scene& scene, const runtime::DeformableBody& body,
                Verdict& verdict) {
    double found = 0;
    for (std::size_t node = 0; node < body.nodes(); ++node) {
        const double mass = body.nodal_mass(static_cast<std::int32_t>(node));
        if (!(mass > 0)) verdict.fail("copy " + std::to_string(node) + " has the mass " + number(mass));
        found += mass;
    }
    const double expected = scene.materials.at(0).density * cut.mesh().volume();
    if (!(std::abs(found / expected - 1) <= 1e-12)) {
        verdict.fail("the copies have " + number(found / expected - 1) + " too much of the mass");
    }
}

/// (u, a) of each node in an enriched basis and back again: equal to some roundings of the largest value there.
void judge_enrichment(const CutMesh& cut, std::span<const Point> positions, runtime::Enrichment enrichment,
                      Random& random, Verdict& verdict) {
    for (std::size_t n = 0; n < cut.mesh().nodes().size(); ++n) {
        const std::vector<std::int32_t> copies = cut.copies_of_node(static_cast<std::int32_t>(n));
        std::vector<runtime::CopyLevel> levels;
        std::vector<Point> values;
        double largest = 0;
        for (const std::int32_t copy : copies) {
            values.push_back(positions[static_cast<std::size_t>(copy)]);
            for (const double value : values.back()) largest = std::max(largest, std::abs(value));
            if (values.size() == 1) continue;
            const auto parent = std::ranges::find(copies, cut.parent_of_copy()[static_cast<std::size_t>(copy)]);
            levels.push_back({static_cast<int>(parent - copies.begin()), random.chance(0.5) ? 1 : -1});
        }
        copies_to_enriched(enrichment, levels, values);
        enriched_to_copies(enrichment, levels, values);
        const double rounding =
            4 * static_cast<double>(copies.size()) * epsilon_of(runtime::ScalarMode::double_precision);
        for (std::size_t k = 0; k < copies.size(); ++k) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double miss = values[k][axis] - positions[static_cast<std::size_t>(copies[k])][axis];
                if (!(std::abs(miss) <= rounding * largest)) {
                    verdict.fail("node " + std::to_string(n) + ": " + std::string(to_string(enrichment)) +
                                 " enrichment and back differ by " + number(miss) + " m");
                }
            }
        }
    }
}

std::string describe(const CutMesh& cut, const runtime::Settings& settings) {
    std::map<std::int32_t, int> parts;
    int most = 0;
    for (const std::int32_t element : cut.element_of_part()) most = std::max(most, ++parts[element]);
    std::ostringstream text;
    text << cut.mesh().tetrahedra().size() << " elements of quality " << number(lowest_quality(cut.mesh()))
         << " and better, " << cut.parts().size() << " parts, up to " << most << " an element, the thinnest "
         << number(thinnest_part(cut)) << ", step " << number(1000 * settings.time_step) << " ms";
    return text.str();
}

Verdict run(const Variant& variant, std::uint64_t seed, runtime::Scheduler& scheduler) {
    Verdict verdict;
    Random random(seed);
    const runtime::Scene scene = random_scene(random_mesh(random), random);
    CutMesh cut(scene.mesh);
    cut_at_random(cut, random, verdict);
    const runtime::Scene parts = divided(scene, cut, variant.fronts);
    runtime::Settings settings = settings_of(variant, scene, scheduler, random.logarithmic(1e-3, 0.1));
    if (random.chance(0.5)) settings.conjugate_gradients = {.iterations = 300, .tolerance = 1e-5};
    verdict.body = describe(cut, settings);
    if (!verdict.survived) return verdict;
    const auto body = make_body(parts, settings, scheduler);
    judge_mass(cut, scene, *body, verdict);
    judge_motion(*body, scheduler, motion_bound(parts, settings), 200, verdict);
    const std::vector<Point> end = positions_of(*body);
    for (const auto enrichment : {runtime::Enrichment::shifted, runtime::Enrichment::heaviside}) {
        judge_enrichment(cut, end, enrichment, random, verdict);
    }
    return verdict;
}

}  // namespace

Category sequences() {
    return {.name = "sequences",
            .criterion =
                "Up to eight random cuts, with sharp or blended fronts: parts are not negative and add up to their "
                "elements within 2^-45, every copy "
                "has mass, and the mass of all is the body's within 1e-12. Then 200 steps under gravity, implicit of 1 "
                "to 100 ms, or explicit of 0.95 of the uncut elements' own critical step (explicit) or of the "
                "assembled body's (explicit-assembled): finite, and the energy is at most what was there and the loads "
                "have put in. Implicit: plus 128 eps of it a step, twice what the energy safeguard allows for "
                "rounding. Explicit, linear: plus the energy of rounded strains, for central differences keep v^2 + "
                "w^2 (1 - 0.95^2) x^2; other materials: plus 0.95^2 / (1 - 0.95^2) of the work, by which that lets the "
                "energy vary. The end goes to both enriched bases and back within rounding. Not promised: "
                "explicit-assembled, whose step is longer, for neighbours hold each other back, and is refused where "
                "the cut body's is shorter; and explicit St. Venant-Kirchhoff, whose stiffness, and so whose critical "
                "step, changes with strain.",
            .variants = with_both_fronts(all_dynamics()),
            .cases = 10000,
            .quick_cases = 140,
            .run = run};
}

}  // namespace lancet::experiments::stability
