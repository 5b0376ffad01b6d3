// Bodies that are cut while they move: nothing jumps, nothing is lost, and what is apart goes its own way.
#include "lancet/runtime/cut/cuttable_body.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/components.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"
#include "lancet/runtime/simulate/loads.hpp"

namespace lancet::test {
namespace {

using mesh::CutSurface;
using mesh::Point;
using runtime::CuttableBody;
using runtime::Settings;

runtime::Scene bar(bool is_fixed) {
    runtime::Scene scene;
    scene.mesh = mesh::box({.cells = {8, 2, 2}, .size = {0.8, 0.2, 0.2}});
    scene.materials = {{0, {.young_modulus = 1e5, .poisson_ratio = 0.33, .density = 500}}};
    if (is_fixed) {
        const auto left = scene.mesh.node_set("x_min");
        scene.fixed_nodes.assign(left.begin(), left.end());
    }
    return scene;
}

/// Solves every step to rounding, in double.
Settings precise(runtime::MassKind mass = runtime::MassKind::lumped) {
    Settings settings;
    settings.time_step = 0.01;
    settings.scalar = runtime::ScalarMode::double_precision;
    settings.mass = mass;
    settings.conjugate_gradients.iterations = 400;
    settings.conjugate_gradients.tolerance = 1e-13;
    return settings;
}

struct State {
    std::vector<Point> positions, velocities;
    explicit State(const runtime::DeformableBody& body) : positions(body.nodes()), velocities(body.nodes()) {
        body.positions(positions);
        body.velocities(velocities);
    }
};

struct Momentum {
    double mass = 0;
    Point linear{}, angular{}, centre{};
};

/// Of each component of a cut body.
std::vector<Momentum> momenta(const CuttableBody& cuttable) {
    const State state(cuttable.body());
    const auto components = mesh::components(state.positions.size(), cuttable.mesh().parts());
    std::vector<Momentum> of_piece(static_cast<std::size_t>(components.count));
    for (std::size_t copy = 0; copy < state.positions.size(); ++copy) {
        Momentum& piece = of_piece[static_cast<std::size_t>(components.of_node[copy])];
        const double mass = cuttable.body().nodal_mass(static_cast<std::int32_t>(copy));
        const Point &x = state.positions[copy], &v = state.velocities[copy];
        piece.mass += mass;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t next = (axis + 1) % 3, last = (axis + 2) % 3;
            piece.linear[axis] += mass * v[axis];
            piece.centre[axis] += mass * x[axis];
            piece.angular[axis] += mass * (x[next] * v[last] - x[last] * v[next]);
        }
    }
    return of_piece;
}

Momentum total(const std::vector<Momentum>& pieces) {
    Momentum sum;
    for (const Momentum& piece : pieces) {
        sum.mass += piece.mass;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            sum.linear[axis] += piece.linear[axis];
            sum.angular[axis] += piece.angular[axis];
        }
    }
    return sum;
}

double distance(const Point& a, const Point& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

TEST(CuttableBody, NothingJumpsWhenASwingingBarIsCut) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    for (const runtime::MassKind mass :
         {runtime::MassKind::lumped, runtime::MassKind::fraction, runtime::MassKind::consistent}) {
        CuttableBody body(bar(true), precise(mass), *scheduler);
        for (int step = 0; step < 10; ++step) body.step(*scheduler);
        double depth = 0.12;
        for (int stroke = 0; stroke < 4; ++stroke, depth += 0.05) {
            const State before(body.body());
            const Momentum whole = total(momenta(body));
            const double time = body.body().time();
            // A blade from above at the place where the bar is now.
            const auto update = body.cut(*scheduler, CutSurface::swept(std::vector<std::array<Point, 2>>{
                                                         {Point{0.33, 0.3 - depth, -1}, Point{0.33, 0.3 - depth, 1}},
                                                         {Point{0.33, 0.3, -1}, Point{0.33, 0.3, 1}}}));
            (void)update;
            const State after(body.body());
            EXPECT_EQ(body.body().time(), time);
            for (std::size_t copy = 0; copy < after.positions.size(); ++copy) {
                std::size_t original = copy;
                while (original >= before.positions.size()) {
                    original = static_cast<std::size_t>(body.mesh().parent_of_copy()[original]);
                }
                EXPECT_EQ(after.positions[copy], before.positions[original]);
                EXPECT_EQ(after.velocities[copy], before.velocities[original]);
            }
            const Momentum cut = total(momenta(body));  // crumbs may come off
            EXPECT_NEAR(cut.mass, whole.mass, 1e-13 * whole.mass);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                EXPECT_NEAR(cut.linear[axis], whole.linear[axis], 1e-13 * whole.mass);
                EXPECT_NEAR(cut.angular[axis], whole.angular[axis], 1e-13 * whole.mass);
            }
            for (int step = 0; step < 5; ++step) EXPECT_FALSE(body.step(*scheduler).lost);
        }
        EXPECT_GT(body.mesh().node_of_copy().size(), body.mesh().mesh().nodes().size());
    }
}

// A plane in the middle of a layer of cells.
TEST(CuttableBody, PiecesKeepTheirMassCentreAndMomentum) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    runtime::Scene scene = bar(false);
    scene.gravity = {0, 0, 0};
    Settings settings = precise();
    settings.integrator = runtime::Integrator::implicit_midpoint;
    settings.energy_safeguard = false;
    settings.newton_iterations = 30;
    settings.newton_tolerance = 1e-12;
    CuttableBody body(scene, settings, *scheduler);
    body.cut(*scheduler, CutSurface::plane({0.33, 0, 0}, {1, 0, 0}), runtime::Configuration::rest);
    const auto at_rest = momenta(body);
    ASSERT_EQ(at_rest.size(), 2U);
    EXPECT_NEAR(at_rest[0].mass, 500 * 0.33 * 0.04, 1e-12);
    EXPECT_NEAR(at_rest[0].centre[0] / at_rest[0].mass, 0.165, 1e-12);
    EXPECT_NEAR(at_rest[1].centre[0] / at_rest[1].mass, 0.565, 1e-12);

    std::vector<Point> velocities(body.body().nodes());
    const State start(body.body());
    for (std::size_t copy = 0; copy < velocities.size(); ++copy) {
        const Point& x = start.positions[copy];
        velocities[copy] = {0.3 * std::sin(9 * x[1]), 0.5 * x[0] + 0.1, -0.4 * x[0] * x[2]};
    }
    body.body().set_velocities(velocities);
    const auto before = momenta(body);
    for (int step = 0; step < 40; ++step) body.step(*scheduler);
    const auto after = momenta(body);
    for (std::size_t piece = 0; piece < 2; ++piece) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(after[piece].linear[axis], before[piece].linear[axis], 1e-9);
            EXPECT_NEAR(after[piece].angular[axis], before[piece].angular[axis], 1e-9);
        }
    }
}

// Along the faces of elements each half is a mesh of its own; rounding differs with the numbering.
TEST(CuttableBody, AHalfMovesAsABodyOfItsOwn) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    runtime::Scene scene = bar(true), half = bar(true);
    half.mesh = mesh::box({.cells = {4, 2, 2}, .size = {0.4, 0.2, 0.2}});
    const auto left = half.mesh.node_set("x_min");
    half.fixed_nodes.assign(left.begin(), left.end());
    Settings settings = precise();
    settings.newton_iterations = 20;
    CuttableBody body(scene, settings, *scheduler);
    body.cut(*scheduler, CutSurface::plane({0.4, 0, 0}, {1, 0, 0}), runtime::Configuration::rest);
    const auto alone = runtime::make_body(half, settings, *scheduler);
    for (int step = 0; step < 30; ++step) {
        body.step(*scheduler);
        alone->step(*scheduler);
    }
    const State both(body.body()), one(*alone);
    const auto components = mesh::components(both.positions.size(), body.mesh().parts());
    double largest = 0;
    int compared = 0;
    for (std::size_t node = 0; node < one.positions.size(); ++node) {
        for (std::size_t copy = 0; copy < both.positions.size(); ++copy) {
            const auto original = static_cast<std::size_t>(body.mesh().node_of_copy()[copy]);
            if (components.of_node[copy] != 0 || scene.mesh.nodes()[original] != half.mesh.nodes()[node]) continue;
            largest = std::max(largest, distance(both.positions[copy], one.positions[node]));
            ++compared;
        }
    }
    EXPECT_EQ(compared, static_cast<int>(one.positions.size()));
    EXPECT_LT(largest, 1e-8);  // the Newton tolerance of the 30 steps
}

TEST(CuttableBody, ACutBodyFallsWithoutStrain) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    for (const bool is_double : {false, true}) {
        for (const runtime::MassKind mass : {runtime::MassKind::lumped, runtime::MassKind::fraction,
                                             runtime::MassKind::weighted_diagonal, runtime::MassKind::consistent}) {
            Settings settings;
            settings.mass = mass;
            settings.scalar = is_double ? runtime::ScalarMode::double_precision : runtime::ScalarMode::single_precision;
            settings.conjugate_gradients.iterations = 3;  // far too few to converge
            CuttableBody body(bar(false), settings, *scheduler);
            body.cut(*scheduler, CutSurface::plane({0.33, 0, 0}, {1, 0.2, 0.1}), runtime::Configuration::rest);
            body.cut(*scheduler, CutSurface::plane({0.1, 0.1, 0.1}, {0.3, 1, 0.1}), runtime::Configuration::rest);
            const State rest(body.body());
            constexpr int steps = 25;
            for (int step = 0; step < steps; ++step) body.step(*scheduler);
            const State fallen(body.body());
            // Backward Euler falls h^2 n (n + 1) / 2 g. The fall is rounded in double; and in every step the rounding
            // of the strains, epsilon, pushes nodes off by less than the size of an element times that.
            const double fall = 9.81 * 0.04 * 0.04 * steps * (steps + 1) / 2;
            const double rounding = 4 * steps * (is_double ? 0x1p-52 : 0x1p-23) * 0.1 + 0x1p-52 * 50 * fall;
            double largest = 0;
            for (std::size_t copy = 0; copy < rest.positions.size(); ++copy) {
                Point expected = rest.positions[copy];
                expected[1] -= fall;
                largest = std::max(largest, distance(fallen.positions[copy], expected));
            }
            EXPECT_LE(largest, rounding) << to_string(mass) << (is_double ? " double" : " float");
        }
    }
}

TEST(CuttableBody, CrossingCutsMakeFourIndependentQuarters) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    for (const runtime::MassKind mass :
         {runtime::MassKind::lumped, runtime::MassKind::fraction, runtime::MassKind::consistent}) {
        runtime::Scene scene = bar(false);
        scene.gravity = {0, 0, 0};
        CuttableBody body(scene, precise(mass), *scheduler);
        body.cut(*scheduler, CutSurface::plane({0.33, 0, 0}, {1, 0.3, 0}), runtime::Configuration::rest);
        body.cut(*scheduler, CutSurface::plane({0, 0.13, 0}, {0.1, 1, 0}), runtime::Configuration::rest);
        ASSERT_EQ(momenta(body).size(), 4U);
        const State rest(body.body());
        // A point of the material in the element at the far corner.
        const std::int32_t element = static_cast<std::int32_t>(scene.mesh.tetrahedra().size()) - 1;
        const CuttableBody::PointLoad push{element, {0.25, 0.25, 0.25, 0.25}, {0.4, 0.2, 0}};
        body.set_point_loads(std::span(&push, 1));
        for (int step = 0; step < 10; ++step) body.step(*scheduler);
        const State pushed(body.body());
        const auto components = mesh::components(rest.positions.size(), body.mesh().parts());
        const std::int32_t part = body.mesh().material_point(element, push.place).part;
        const std::int32_t pushed_piece = components.of_element[static_cast<std::size_t>(part)];
        for (std::size_t copy = 0; copy < rest.positions.size(); ++copy) {
            if (components.of_node[copy] == pushed_piece) {
                EXPECT_GT(distance(pushed.positions[copy], rest.positions[copy]), 1e-4);
            } else {
                EXPECT_LT(distance(pushed.positions[copy], rest.positions[copy]), 1e-15);  // rounding of the rest
            }
        }
    }
}

/// The same elements, each with nodes of its own: what any number of cuts along faces would leave.
runtime::Scene apart(const runtime::Scene& scene) {
    mesh::TetMesh::Definition definition;
    for (const mesh::Tetrahedron& t : scene.mesh.tetrahedra()) {
        const auto first = static_cast<std::int32_t>(definition.nodes.size());
        for (const std::int32_t node : t)
            definition.nodes.push_back(scene.mesh.nodes()[static_cast<std::size_t>(node)]);
        definition.tetrahedra.push_back({first, first + 1, first + 2, first + 3});
    }
    runtime::Scene result = scene;
    result.mesh = mesh::TetMesh(std::move(definition));
    return result;
}

// The bound of part_mass.hpp: the critical step of the elements one by one. The whole body's own is somewhat longer,
// since neighbours hold each other, and falls towards the bound when they are cut off.
TEST(CuttableBody, NoCutShortensTheCriticalStepOfTheElementsUnderFractionLumping) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    Settings settings = precise(runtime::MassKind::fraction);
    settings.integrator = runtime::Integrator::central_differences;
    settings.energy_safeguard = false;
    settings.time_step = 1e-5;
    const double bound = make_body(apart(bar(false)), settings, *scheduler)->critical_time_step(*scheduler);
    CuttableBody body(bar(false), settings, *scheduler);
    EXPECT_GT(body.body().critical_time_step(*scheduler), bound);
    double x = 0.3;
    for (const double thickness : {1e-2, 1e-6, 1e-12}) {
        // Close to the faces at 0.3, 0.4, 0.5: slivers of the third power.
        body.cut(*scheduler, CutSurface::plane({x + thickness, 0, 0}, {1, 0, 0}), runtime::Configuration::rest);
        body.cut(*scheduler, CutSurface::plane({x, 0.1 - thickness, 0}, {0.2, 1, 0}), runtime::Configuration::rest);
        EXPECT_GE(body.body().critical_time_step(*scheduler), bound * (1 - 1e-5));
        x += 0.1;
    }
}

TEST(CuttableBody, TheMassFollowsTheIntegratorByDefault) {
    Settings settings;
    EXPECT_EQ(mass_kind(settings), runtime::MassKind::lumped);
    settings.integrator = runtime::Integrator::symplectic_euler;
    EXPECT_EQ(mass_kind(settings), runtime::MassKind::fraction);
    settings.mass = runtime::MassKind::lumped;
    EXPECT_EQ(mass_kind(settings), runtime::MassKind::lumped);
}

TEST(CuttableBody, HoldsAreOfAllCopiesAndOutliveACut) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    CuttableBody body(bar(true), precise(), *scheduler);
    const auto nodes = body.mesh().mesh().nodes();
    std::int32_t held = -1;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        if (distance(nodes[n], {0.4, 0.2, 0.1}) < 1e-9) held = static_cast<std::int32_t>(n);
    }
    ASSERT_GE(held, 0);
    body.hold(held, {0.4, 0.25, 0.1});
    body.step(*scheduler);
    body.cut(*scheduler, CutSurface::plane({0.4, 0, 0}, {1, 0, 0}), runtime::Configuration::rest);
    const auto copies = body.mesh().copies_of_node(held);
    ASSERT_EQ(copies.size(), 2U);
    for (int step = 0; step < 3; ++step) body.step(*scheduler);
    State state(body.body());
    for (const std::int32_t copy : copies) {
        EXPECT_LT(distance(state.positions[static_cast<std::size_t>(copy)], {0.4, 0.25, 0.1}), 1e-12);
    }
    body.release(held);
    for (int step = 0; step < 3; ++step) body.step(*scheduler);
    state = State(body.body());
    EXPECT_GT(distance(state.positions[static_cast<std::size_t>(copies[1])], {0.4, 0.25, 0.1}), 1e-4);
}

TEST(CuttableBody, LoadsOnTheSurfaceArePartedByTheirMaterial) {
    runtime::Scene scene = bar(true);
    runtime::Traction traction{.triangles = {}, .force_per_area = {0, 3, 0}};
    const auto top = scene.mesh.node_set("y_max");
    std::vector<bool> is_top(scene.mesh.nodes().size(), false);
    for (const std::int32_t node : top) is_top[static_cast<std::size_t>(node)] = true;
    for (const mesh::Tetrahedron& t : scene.mesh.tetrahedra()) {
        for (std::size_t k = 0; k < 4; ++k) {
            const mesh::Triangle face{t[(k + 1) % 4], t[(k + 2) % 4], t[(k + 3) % 4]};
            if (std::ranges::all_of(face, [&](auto n) { return is_top[static_cast<std::size_t>(n)]; })) {
                traction.triangles.push_back(face);
            }
        }
    }
    scene.tractions = {traction};
    scene.edge_loads = {{{0, 1}, {7, 0, 0}}};
    mesh::CutMesh cut(scene.mesh);
    cut.cut(CutSurface::plane({0.33, 0, 0}, {1, 0, 0.2}));
    cut.cut(CutSurface::plane({0.04, 0, 0}, {1, 0, 0}));
    const runtime::Scene parts = divided(scene, cut);
    const auto loads = external_loads(parts);
    const auto components = mesh::components(parts.mesh.nodes().size(), parts.mesh.tetrahedra());
    ASSERT_EQ(components.count, 3);
    std::vector<Point> force(3);
    for (std::size_t copy = 0; copy < loads.size(); ++copy) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            force[static_cast<std::size_t>(components.of_node[copy])][axis] += loads[copy][axis];
        }
    }
    // Top faces of 0.04, 0.33 - 0.02 - 0.04 and the rest times 0.2 m; the edge of 0.1 m is cut at 0.04.
    EXPECT_NEAR(force[0][1], 3 * 0.2 * 0.04, 1e-14);
    EXPECT_NEAR(force[1][1], 3 * 0.2 * (0.33 - 0.02 - 0.04), 1e-14);
    EXPECT_NEAR(force[2][1], 3 * 0.2 * (0.8 - 0.31), 1e-14);
    EXPECT_NEAR(force[0][0], 7 * 0.04, 1e-14);
    EXPECT_NEAR(force[1][0], 7 * 0.06, 1e-14);
}

TEST(CuttableBody, CrumbsAreListedAndKeptFrozenOrDropped) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    for (const auto treatment :
         {runtime::CrumbTreatment::keep, runtime::CrumbTreatment::freeze, runtime::CrumbTreatment::drop}) {
        EXPECT_EQ(runtime::crumb_treatment_from_string(to_string(treatment)), treatment);
        CuttableBody body(bar(true), precise(), *scheduler, {.crumbs = treatment});
        for (int step = 0; step < 5; ++step) body.step(*scheduler);
        // A corner of the free end, which has sunk by now, of three cuts' length 0.03.
        const auto update =
            body.cut(*scheduler, CutSurface::plane({0.77, 0.2, 0.2}, {1, 1, 1}), runtime::Configuration::rest);
        ASSERT_EQ(update.crumbs.size(), 1U);
        EXPECT_NEAR(update.crumbs[0].volume, 0.03 * 0.03 * 0.03 / 6, 1e-15);
        const auto crumb = static_cast<std::size_t>(update.crumbs[0].nodes.front());
        const State before(body.body());
        for (int step = 0; step < 5; ++step) EXPECT_FALSE(body.step(*scheduler).lost);
        const State after(body.body());
        const double mass = total(momenta(body)).mass;
        const double moved = distance(before.positions[crumb], after.positions[crumb]);
        if (treatment == runtime::CrumbTreatment::keep) {
            EXPECT_GT(moved, 1e-2);
        } else {
            EXPECT_LT(moved, 1e-12);
        }
        const double dropped = treatment == runtime::CrumbTreatment::drop ? 500 * update.crumbs[0].volume : 0;
        EXPECT_NEAR(mass, 16 - dropped, 1e-12);
    }
    EXPECT_THROW((void)runtime::crumb_treatment_from_string("eat"), Error);
}

TEST(CuttableBody, ScenesThatDoNotFitAreRefused) {
    const runtime::Scene scene = bar(true);
    mesh::CutMesh other(mesh::box({.cells = {2, 2, 2}}));
    EXPECT_THROW((void)divided(scene, other), Error);
    mesh::CutMesh cut(scene.mesh);
    cut.cut(CutSurface::plane({0.33, 0, 0}, {1, 0, 0}));
    const runtime::Scene parts = divided(scene, cut);
    EXPECT_THROW((void)divided(parts, cut), Error);
}

}  // namespace
}  // namespace lancet::test
