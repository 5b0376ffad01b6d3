// NaN, infinity and numbers beyond the scalar, put into one element through every door that is open to a caller.

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "lancet/experiments/stability/bodies.hpp"
#include "lancet/experiments/stability/judges.hpp"
#include "lancet/experiments/stability/settings.hpp"
#include "lancet/experiments/stability/subjects.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"

namespace lancet::experiments::stability {

namespace {

using mesh::CutMesh;
using mesh::CutSurface;
using mesh::Point;
using runtime::DeformableBody;
using runtime::ScalarMode;
using runtime::Scene;

struct Ground {
    Scene scene;
    CutMesh cut;
    Scene parts;  ///< the scene divided
    std::size_t element;
};

Ground ground_of(Random& random) {
    Scene scene;
    scene.mesh = mesh::box({.cells = {4, 2, 2}, .size = {1, 0.5, 0.5}});
    scene.fixed_nodes = nodes_at_end(scene.mesh, false);
    CutMesh cut(scene.mesh);
    cut.cut(CutSurface::half_plane({0.6, 0, 0.2}, {1, 0, 0.2}, {0, 0, -1}));
    Scene parts = divided(scene, cut);
    // Not an element whose nodes are all held: nothing put there has an effect.
    while (true) {
        const std::size_t element = random.below(parts.mesh.tetrahedra().size());
        const bool is_free = std::ranges::none_of(parts.mesh.tetrahedra()[element], [&](std::int32_t node) {
            return std::ranges::find(parts.fixed_nodes, node) != parts.fixed_nodes.end();
        });
        if (is_free) return {scene, cut, parts, element};
    }
}

/// A value for each node, `base` but at the corners of the element, where it is `bad`.
std::vector<Point> with_bad_corners(const Ground& ground, std::vector<Point> base, double bad, Random& random) {
    for (const std::int32_t node : ground.parts.mesh.tetrahedra()[ground.element]) {
        if (std::isfinite(bad)) {
            for (double& x : base[static_cast<std::size_t>(node)]) x = random.chance(0.5) ? bad : -bad;
        } else {
            base[static_cast<std::size_t>(node)][random.below(3)] = bad;
        }
    }
    return base;
}

std::vector<Point> rest_of(const Ground& ground) {
    return {ground.parts.mesh.nodes().begin(), ground.parts.mesh.nodes().end()};
}

std::vector<Point> nothing(const Ground& ground) {
    return std::vector<Point>(ground.parts.mesh.nodes().size(), Point{});
}

/// What is done to a body that is there.
using Injection = std::function<void(const Ground&, DeformableBody&, double bad, Random&)>;
const std::map<std::string, Injection>& injections() {
    static const std::map<std::string, Injection> all{
        {"positions",
         [](const Ground& ground, DeformableBody& body, double bad, Random& random) {
             body.set_positions(with_bad_corners(ground, rest_of(ground), bad, random));
         }},
        {"velocities",
         [](const Ground& ground, DeformableBody& body, double bad, Random& random) {
             body.set_velocities(with_bad_corners(ground, nothing(ground), bad, random));
         }},
        {"loads", [](const Ground& ground, DeformableBody& body, double bad,
                     Random& random) { body.set_loads(with_bad_corners(ground, nothing(ground), bad, random)); }},
        {"hold", [](const Ground& ground, DeformableBody& body, double bad, Random& random) {
             body.hold(ground.parts.mesh.tetrahedra()[ground.element][random.below(4)], {bad, 0, 0});
         }}};
    return all;
}

/// What makes, or should not make, a body.
using Construction = std::function<void(const Ground&, double bad, const runtime::Settings&, runtime::Scheduler&)>;
void build(const Scene& scene, const runtime::Settings& settings, runtime::Scheduler& scheduler) {
    make_body(scene, settings, scheduler)->step(scheduler);
}
const std::map<std::string, Construction>& constructions() {
    static const std::map<std::string, Construction> all{
        {"young",
         [](const Ground& ground, double bad, const runtime::Settings& settings, runtime::Scheduler& scheduler) {
             Scene scene = ground.parts;
             scene.materials[0].young_modulus = bad;
             build(scene, settings, scheduler);
         }},
        {"density",
         [](const Ground& ground, double bad, const runtime::Settings& settings, runtime::Scheduler& scheduler) {
             Scene scene = ground.parts;
             scene.materials[0].density = bad;
             build(scene, settings, scheduler);
         }},
        {"gravity",
         [](const Ground& ground, double bad, const runtime::Settings& settings, runtime::Scheduler& scheduler) {
             Scene scene = ground.parts;
             scene.gravity[1] = bad;
             build(scene, settings, scheduler);
         }},
        {"nodal-load",
         [](const Ground& ground, double bad, const runtime::Settings& settings, runtime::Scheduler& scheduler) {
             Scene scene = ground.scene;
             scene.nodal_loads.push_back({static_cast<std::int32_t>(scene.mesh.nodes().size()) - 1, {bad, 0, 0}});
             build(divided(scene, ground.cut), settings, scheduler);
         }},
        {"prescribed",
         [](const Ground& ground, double bad, const runtime::Settings& settings, runtime::Scheduler& scheduler) {
             Scene scene = ground.scene;
             const auto last = static_cast<std::int32_t>(scene.mesh.nodes().size()) - 1;
             scene.prescribed.push_back({last, 0, [bad](double) { return bad; }});
             build(divided(scene, ground.cut), settings, scheduler);
         }},
        {"mesh",
         [](const Ground& ground, double bad, const runtime::Settings& settings, runtime::Scheduler& scheduler) {
             mesh::TetMesh::Definition definition = ground.scene.mesh.definition();
             definition.nodes.back()[2] = bad;
             Scene scene = ground.scene;
             scene.mesh = mesh::TetMesh(std::move(definition));
             build(scene, settings, scheduler);
         }},
        {"fraction",
         [](const Ground& ground, double bad, const runtime::Settings& settings, runtime::Scheduler& scheduler) {
             Scene scene = ground.parts;
             scene.parts.moments.front().fraction = bad;
             build(scene, settings, scheduler);
         }},
        {"moment",
         [](const Ground& ground, double bad, const runtime::Settings& settings, runtime::Scheduler& scheduler) {
             Scene scene = ground.parts;
             scene.parts.moments.front().first[1] = bad;
             build(scene, settings, scheduler);
         }},
        {"time-step",
         [](const Ground& ground, double bad, const runtime::Settings& settings, runtime::Scheduler& scheduler) {
             runtime::Settings own = settings;
             own.time_step = bad;
             build(ground.parts, own, scheduler);
         }},
        {"cut-plane",
         [](const Ground& ground, double bad, const runtime::Settings&, runtime::Scheduler&) {
             CutMesh cut = ground.cut;
             cut.cut(CutSurface::plane({bad, 0, 0}, {1, 0, 0}));
         }},
        {"cut-places",
         [](const Ground& ground, double bad, const runtime::Settings&, runtime::Scheduler&) {
             CutMesh cut = ground.cut;
             std::vector<Point> places = cut.rest_positions();
             places[static_cast<std::size_t>(cut.parts()[ground.element][0])][0] = bad;
             cut.cut(CutSurface::plane({0.4, 0.1, 0.1}, {1, 1, 0.3}), mesh::FrontTreatment::retract, places);
         }},
        {"cut-level-set", [](const Ground& ground, double bad, const runtime::Settings&, runtime::Scheduler&) {
             CutMesh cut = ground.cut;
             cut.cut(CutSurface::level_set([bad](const Point& x) { return x[0] > 0.5 ? bad : x[0] - 0.3; }));
         }}};
    return all;
}

/// A finite number: the body goes on, finite, and says which steps it could not take.
void judge_going_on(DeformableBody& body, runtime::Scheduler& scheduler, Verdict& verdict) {
    int lost = 0;
    for (int step = 1; step <= 200 && verdict.survived; ++step) {
        lost += body.step(scheduler).lost ? 1 : 0;
        std::vector<Point> velocities(body.nodes());
        body.velocities(velocities);
        if (!is_finite(positions_of(body)) || !is_finite(velocities)) {
            verdict.fail("step " + std::to_string(step) + ": positions or velocities are not finite");
        }
    }
    if (body.totals().lost != lost) verdict.fail("lost steps are not counted as reported");
    verdict.error = lost;
}

Verdict run(const Variant& variant, std::uint64_t seed, runtime::Scheduler& scheduler) {
    Verdict verdict;
    Random random(seed);
    const Ground ground = ground_of(random);
    const runtime::Settings settings = settings_of(variant, ground.scene, scheduler, random.logarithmic(1e-3, 0.1));
    const std::string where = variant.detail.substr(0, variant.detail.rfind('-'));
    verdict.body = "element " + std::to_string(ground.element);
    bool was_refused = false;
    const auto refused = [&](const auto& injection) {
        try {
            injection();
        } catch (const Error&) {
            was_refused = true;
        }
    };
    if (const auto found = constructions().find(where); found != constructions().end()) {
        refused([&] { found->second(ground, variant.number, settings, scheduler); });
        if (!was_refused) verdict.fail("it was taken without an error");
        return verdict;
    }
    const auto body = make_body(ground.parts, settings, scheduler);
    const auto twin = make_body(ground.parts, settings, scheduler);
    for (int step = 0; step < 5; ++step) {
        body->step(scheduler);
        twin->step(scheduler);
    }
    refused([&] { injections().at(where)(ground, *body, variant.number, random); });
    if (std::isfinite(variant.number)) {
        if (!was_refused) judge_going_on(*body, scheduler, verdict);
        return verdict;
    }
    if (!was_refused) verdict.fail("it was taken without an error");
    for (int step = 0; step < 20; ++step) {
        body->step(scheduler);
        twin->step(scheduler);
    }
    if (positions_of(*body) != positions_of(*twin)) verdict.fail("the refused input left a trace");
    return verdict;
}

}  // namespace

Category not_finite() {
    Category category{
        .name = "not-finite",
        .criterion =
            "NaN and infinity in one element, through each door: refused with an error, and a body goes on to "
            "the bit as one that was never asked. Finite numbers beyond the scalar (1e30, 1e200): refused, or "
            "taken and positions and velocities are finite after each of 200 steps, those that could not be "
            "taken being reported as lost; the column 'error' counts them.",
        .variants = {},
        .run = run};
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const auto add = [&](const std::string& where, const std::string& what, double value, bool is_explicit) {
        for (const ScalarMode scalar : {ScalarMode::single_precision, ScalarMode::double_precision}) {
            category.variants.push_back({.detail = where + "-" + what,
                                         .number = value,
                                         .mass = is_explicit ? runtime::MassKind::fraction : runtime::MassKind::lumped,
                                         .scalar = scalar,
                                         .stepping = is_explicit ? Stepping::explicit_element : Stepping::implicit});
        }
    };
    for (const auto& [where, injection] : injections()) {
        for (const bool is_explicit : {false, true}) {
            add(where, "nan", std::numeric_limits<double>::quiet_NaN(), is_explicit);
            add(where, "inf", infinity, is_explicit);
            add(where, "1e30", 1e30, is_explicit);
            add(where, "1e200", 1e200, is_explicit);
        }
    }
    for (const auto& [where, construction] : constructions()) {
        add(where, "nan", std::numeric_limits<double>::quiet_NaN(), false);
        add(where, "inf", infinity, false);
    }
    category.cases = 8 * static_cast<int>(category.variants.size());
    category.quick_cases = static_cast<int>(category.variants.size());
    return category;
}

}  // namespace lancet::experiments::stability
