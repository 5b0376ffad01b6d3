// Cases: their names, their seeds, and the bodies and surfaces that come of them.
#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "lancet/experiments/stability/bodies.hpp"
#include "lancet/experiments/stability/case.hpp"
#include "lancet/experiments/stability/surfaces.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/mesh/generate/box.hpp"

namespace lancet::experiments::stability {
namespace {

TEST(StabilityCases, EveryVariantHasANameOfItsOwnThatFindsIt) {
    std::set<std::string> names;
    for (std::size_t c = 0; c < categories().size(); ++c) {
        for (std::size_t v = 0; v < categories()[c].variants.size(); ++v) {
            const std::string name = case_name(categories()[c], categories()[c].variants[v]);
            EXPECT_TRUE(names.insert(name).second) << name;
            const Case found = case_named(name, 42);
            EXPECT_EQ(found.category, c);
            EXPECT_EQ(found.variant, v);
            EXPECT_EQ(found.seed, 42U);
        }
    }
    EXPECT_THROW(case_named("sequences", 1), Error);
}

TEST(StabilityCases, AllVariantsOfAllCategoriesTakeTurns) {
    std::set<std::pair<std::size_t, std::size_t>> met;
    std::size_t variants = 0;
    for (const Category& category : categories()) variants += category.variants.size();
    for (const Case& one : cases_of({})) met.insert({one.category, one.variant});
    EXPECT_EQ(met.size(), variants);
    std::size_t sequences = 0;
    for (const Case& one : cases_of({.categories = {"sequences"}})) {
        EXPECT_EQ(categories()[one.category].name, "sequences");
        ++sequences;
    }
    EXPECT_EQ(sequences, 10000U);
    for (const Case& one : cases_of({.scalars = {"float"}, .cases = 5})) {
        EXPECT_EQ(categories()[one.category].variants[one.variant].scalar, runtime::ScalarMode::single_precision);
    }
}

TEST(StabilityCases, BodiesAndSurfacesFollowFromTheSeed) {
    double worst = 1;
    bool is_far = false;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        Random first(seed), second(seed);
        const mesh::TetMesh mesh = random_mesh(first), again = random_mesh(second);
        EXPECT_TRUE(std::ranges::equal(mesh.nodes(), again.nodes()));
        worst = std::min(worst, lowest_quality(mesh));
        is_far = is_far || std::abs(mesh.bounds()[0][0]) > 20;
        mesh::CutMesh cut(mesh), cut_again(mesh);
        cut.cut(random_surface(cut, 0, cut.rest_positions(), first));
        cut_again.cut(random_surface(cut_again, 0, cut_again.rest_positions(), second));
        EXPECT_TRUE(std::ranges::equal(cut.parts(), cut_again.parts()));
    }
    EXPECT_LT(worst, 1e-5);
    EXPECT_TRUE(is_far);
}

TEST(StabilityCases, ABadElementHasTheQualityThatIsAskedFor) {
    const mesh::TetMesh mesh = mesh::box({.cells = {3, 3, 3}});
    EXPECT_NEAR(quality(mesh::box({}), 4), 1, 0.5);
    for (const double wanted : {1e-2, 1e-4, 1e-6}) {
        Random random(3);
        const double found = lowest_quality(with_bad_element(mesh, wanted, random));
        EXPECT_GT(found, 0.1 * wanted);
        EXPECT_LT(found, 10 * wanted);
    }
}

TEST(StabilityCases, TheFacesAroundANodeCutItsNeighbourhoodOut) {
    mesh::CutMesh cut(mesh::box({.cells = {2, 2, 2}, .split = mesh::Split::six}));
    const auto report = cut.cut(around_node(cut, 13));  // in the middle
    EXPECT_EQ(report.new_parts, 0);
    const std::span<const std::int32_t> star = cut.star(13);
    for (std::size_t e = 0; e < cut.parts().size(); ++e) {
        const bool is_inside = std::ranges::find(star, static_cast<std::int32_t>(e)) != star.end();
        for (const std::int32_t copy : cut.parts()[e]) {
            for (std::size_t other = 0; other < cut.parts().size(); ++other) {
                const bool is_other_inside = std::ranges::find(star, static_cast<std::int32_t>(other)) != star.end();
                if (is_inside == is_other_inside) continue;
                EXPECT_EQ(std::ranges::find(cut.parts()[other], copy), cut.parts()[other].end());
            }
        }
    }
}

}  // namespace
}  // namespace lancet::experiments::stability
