// The critical step of a single cut tetrahedron by dense matrices, in every basis and with every lumping: what 0.95 of
// the uncut critical step survives.

#include <algorithm>
#include <cmath>

#include "lancet/experiments/stability/judges.hpp"
#include "lancet/experiments/stability/random.hpp"
#include "lancet/experiments/stability/subjects.hpp"
#include "lancet/mesh/tet_mesh.hpp"
#include "lancet/runtime/cut/critical_step_study.hpp"

namespace lancet::experiments::stability {

namespace {

using runtime::Enrichment;
using runtime::StudyLumping;

constexpr std::array lumpings{StudyLumping::enrichment, StudyLumping::row_sum, StudyLumping::weighted_diagonal,
                              StudyLumping::consistent, StudyLumping::fraction};

StudyLumping lumping_named(const std::string& name) {
    return *std::ranges::find_if(lumpings, [&](StudyLumping lumping) { return to_string(lumping) == name; });
}

/// A tetrahedron with random corners, of a quality of some percent and more.
std::array<mesh::Point, 4> random_tetrahedron(Random& random) {
    while (true) {
        std::array<mesh::Point, 4> corners{};
        for (auto& corner : corners) corner = {random.uniform(), random.uniform(), random.uniform()};
        const double volume = mesh::signed_volume(corners[0], corners[1], corners[2], corners[3]);
        if (std::abs(volume) < 0.01) continue;
        if (volume < 0) std::swap(corners[2], corners[3]);
        return corners;
    }
}

Verdict run(const Variant& variant, std::uint64_t seed, runtime::Scheduler&) {
    Random random(seed);
    // Poisson's ratio where dense eigenvalues keep their digits; larger ones are a category of their own.
    const auto element = runtime::study_tetrahedron(random_tetrahedron(random), random.uniform(0, 0.45));
    const bool is_edge = random.chance(0.5);
    const auto parts = is_edge ? runtime::cut_off_edge(variant.number) : runtime::cut_off_corner(variant.number);
    const runtime::CutElement cut{.element = element,
                                  .parts = {runtime::study_part(parts[0]), runtime::study_part(parts[1])},
                                  .cuts = {{.from = 0}},
                                  .corner_parts = {0, is_edge ? 0 : 1, 1, 1}};
    Verdict verdict;
    const double ratio = critical_step_ratio(cut, variant.enrichment, lumping_named(variant.lumping));
    verdict.body = is_edge ? "an edge cut off" : "a corner cut off";
    verdict.error = ratio;
    if (!(ratio >= 0.95)) verdict.fail("the critical step is " + number(ratio) + " of the uncut one");
    return verdict;
}

}  // namespace

Category critical_steps() {
    Category category{
        .name = "critical-steps",
        .criterion =
            "One random tetrahedron, cut so that the given fraction is on one side: its critical step, from dense "
            "matrices in this basis and lumping, is at least 0.95 of that of the whole, row-sum lumped one, so that "
            "explicit steps of 0.95 of the uncut critical step stay stable. Promised for fraction lumping, whose step "
            "no cut shortens; the column 'error' is the ratio.",
        .variants = {},
        .cases = 2100,
        .quick_cases = 210,
        .run = run};
    for (const int exponent : {-2, -4, -6, -8, -10, -12, -14}) {
        for (const Enrichment enrichment : {Enrichment::substituted, Enrichment::shifted, Enrichment::heaviside}) {
            for (const StudyLumping lumping : lumpings) {
                category.variants.push_back(
                    {.detail = power_of_ten(exponent),
                     .number = std::pow(10.0, exponent),
                     .enrichment = enrichment,
                     .lumping = std::string(to_string(lumping)),
                     .model = runtime::ElementModel::linear,
                     .has_dynamics = false,
                     .is_promised = lumping == StudyLumping::fraction && enrichment == Enrichment::substituted});
            }
        }
    }
    return category;
}

}  // namespace lancet::experiments::stability
