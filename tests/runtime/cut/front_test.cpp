// Fronts of cuts inside of elements: sharp ones move from node to node, blended ones with the blade.
#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "lancet/mesh/components.hpp"
#include "lancet/mesh/cut/lanes.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/cut/cuttable_body.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"
#include "lancet/runtime/simulate/equilibrium.hpp"

namespace lancet::test {
namespace {

using mesh::CutMesh;
using mesh::CutSurface;
using mesh::Fronts;
using mesh::Point;

/// The beam of Schoch et al. 2013, bent by its weight across a cut in the middle.
runtime::Scene beam(mesh::TetMesh mesh) {
    runtime::Scene scene;
    scene.mesh = std::move(mesh);
    for (std::size_t node = 0; node < scene.mesh.nodes().size(); ++node) {
        if (scene.mesh.nodes()[node][2] == 0) scene.fixed_nodes.push_back(static_cast<std::int32_t>(node));
    }
    scene.materials = {{0, {.young_modulus = 3e5, .poisson_ratio = 0.35, .density = 1070}}};
    scene.gravity = {9.81, 0, 0};
    return scene;
}

mesh::TetMesh beam_mesh(int layers, mesh::Split split) {
    return mesh::box({.cells = {4, 8, layers}, .size = {0.03, 0.06, 0.2}, .split = split, .swap_parity = true});
}

double energy(const runtime::Scene& scene, runtime::ElementModel model) {
    const auto scheduler = runtime::make_scheduler(runtime::default_scheduler, 2);
    runtime::EquilibriumSettings settings;
    settings.model = model;
    settings.tolerance = 1e-8;
    std::vector<Point> positions(scene.mesh.nodes().begin(), scene.mesh.nodes().end());
    const auto report = find_equilibrium(scene, settings, *scheduler, positions);
    EXPECT_EQ(report.end, runtime::EquilibriumEnd::converged) << report.explanation;
    return report.elastic_energy;
}

/// The energy with the front on faces: the nearest nodes are moved there, the others between evenly.
double aligned_energy(double front, double nearest, mesh::Split split, runtime::ElementModel model) {
    auto definition = beam_mesh(26, split).definition();
    definition.node_sets.clear();
    double height = 0;
    for (Point& node : definition.nodes) {
        if (std::abs(node[2] - 0.1) < 1e-9) height = node[2];
        if (std::abs(node[0] - nearest) < 1e-9) {
            node[0] = front;
        } else {
            node[0] = node[0] < nearest ? node[0] * front / nearest
                                        : front + (node[0] - nearest) * (0.03 - front) / (0.03 - nearest);
        }
    }
    const runtime::Scene scene = beam(mesh::TetMesh(std::move(definition)));
    CutMesh cut(scene.mesh);
    cut.cut(CutSurface::half_plane({front, 0, height}, {0, 0, 1}, {-1, 0, 0}));
    return energy(divided(scene, cut), model);
}

// Through one cell in 20 steps: the energy of a blended front grows continuously, that of sharp ones in steps; and its
// distance from meshes that follow the cut is below both of theirs.
TEST(Front, BlendedMovesContinuouslyAndIsNearestToAlignedMeshes) {
    for (const mesh::Split split : {mesh::Split::five, mesh::Split::six}) {
        const auto model =
            split == mesh::Split::five ? runtime::ElementModel::linear : runtime::ElementModel::corotational;
        const runtime::Scene scene = beam(beam_mesh(27, split));
        constexpr int steps = 20;
        constexpr double from = 0.015, to = 0.0225;
        double error_retract = 0, error_extend = 0, error_blended = 0;
        std::vector<double> blended, retracted;
        for (int step = 0; step <= steps; ++step) {
            const double front = from + (to - from) * step / steps;
            const auto surface = CutSurface::half_plane({front, 0, 0.1}, {0, 0, 1}, {-1, 0, 0});
            CutMesh retract(scene.mesh), extend(scene.mesh);
            retract.cut(surface);
            extend.cut(surface, mesh::FrontTreatment::extend);
            const double aligned = aligned_energy(front, 2 * step <= steps ? from : to, split, model);
            retracted.push_back(energy(divided(scene, retract), model));
            blended.push_back(energy(divided(scene, retract, Fronts::blended), model));
            error_retract += std::abs(retracted.back() / aligned - 1) / (steps + 1);
            error_extend += std::abs(energy(divided(scene, extend), model) / aligned - 1) / (steps + 1);
            error_blended += std::abs(blended.back() / aligned - 1) / (steps + 1);
        }
        double largest_step = 0, largest_retracted = 0;
        for (int step = 1; step <= steps; ++step) {
            EXPECT_GT(blended[step], blended[step - 1]) << "step " << step;
            largest_step = std::max(largest_step, blended[step] - blended[step - 1]);
            largest_retracted = std::max(largest_retracted, retracted[step] - retracted[step - 1]);
        }
        // The energy release grows by some three times along the cell; a jump would be all of it in one step.
        EXPECT_LT(largest_step, 3 * (blended.back() - blended.front()) / steps);
        EXPECT_GT(largest_retracted, 0.3 * (retracted.back() - retracted.front()));
        std::printf("    mean distance from aligned meshes: retract %.2f %%, extend %.2f %%, blended %.2f %%\n",
                    100 * error_retract, 100 * error_extend, 100 * error_blended);
        EXPECT_LT(error_blended, 0.5 * error_extend);
        EXPECT_LT(error_blended, 0.5 * error_retract);
    }
}

/// Cuts that end inside in several places, some of them crossing.
CutMesh partly_cut(const mesh::TetMesh& mesh) {
    CutMesh cut(mesh);
    cut.cut(CutSurface::half_plane({0.61, 0, 0.33}, {0.1, 0, 1}, {-1, 0, 0}));
    cut.cut(CutSurface::parallelogram({0.2, 0.2, 0.55}, {0.43, 0.1, 0.05}, {0.02, 0.51, 0.04}));
    cut.cut(CutSurface::half_plane({0, 0.44, 0.7}, {1, 0.2, 0}, {0, -1, 0}));
    cut.cut(CutSurface::plane({0.83, 0, 0}, {1, 0, 0.1}));
    return cut;
}

TEST(Front, BlendedLanesAddUpToTheirElements) {
    for (const mesh::Split split : {mesh::Split::five, mesh::Split::six}) {
        const CutMesh cut = partly_cut(mesh::box({.cells = {5, 5, 5}, .split = split}));
        for (const Fronts fronts : {Fronts::sharp, Fronts::blended}) {
            const mesh::Lanes lanes = mesh::lanes(cut, fronts);
            EXPECT_EQ(lanes.opened_from.empty(), fronts == Fronts::sharp);
            std::vector<mesh::PartMoments> sums(cut.mesh().tetrahedra().size(), mesh::empty_moments());
            std::vector<bool> is_used(lanes.node_of_copy.size(), false);
            for (const mesh::Lanes::Lane& lane : lanes.lanes) {
                add_weighted(sums[static_cast<std::size_t>(lane.element)], lane.moments, 1);
                EXPECT_GT(lane.moments.fraction, 0);
                for (std::size_t k = 0; k < 4; ++k) {
                    const auto copy = static_cast<std::size_t>(lane.copies[k]);
                    is_used[copy] = true;
                    EXPECT_EQ(lanes.node_of_copy[copy],
                              cut.mesh().tetrahedra()[static_cast<std::size_t>(lane.element)][k]);
                }
            }
            EXPECT_TRUE(std::ranges::all_of(is_used, [](bool used) { return used; }));
            for (const mesh::PartMoments& sum : sums) {
                // Some tens of roundings of pieces that have no sign.
                EXPECT_NEAR(sum.fraction, 1, 1e-13);
                for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(sum.first[i], 0.25, 1e-13);
            }
        }
    }
}

TEST(Front, BlendedPassesThePatchTest) {
    runtime::Scene scene;
    scene.mesh = mesh::box({.cells = {5, 5, 5}});
    const CutMesh cut = partly_cut(scene.mesh);
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    runtime::Settings settings;
    settings.scalar = runtime::ScalarMode::double_precision;
    for (const auto model : {runtime::ElementModel::linear, runtime::ElementModel::corotational,
                             runtime::ElementModel::st_venant_kirchhoff}) {
        settings.model = model;
        settings.tangent =
            model == runtime::ElementModel::linear ? runtime::TangentKind::rotated : runtime::TangentKind::exact;
        const auto deformed_energy = [&](const runtime::Scene& divided_scene) {
            const auto body = make_body(divided_scene, settings, *scheduler);
            std::vector<Point> positions;
            for (const Point& x : divided_scene.mesh.nodes()) {
                positions.push_back({1.1 * x[0] + 0.2 * x[1], 0.9 * x[1] - 0.1 * x[2], x[2] + 0.05 * x[0]});
            }
            body->set_positions(positions);
            return body->energies(*scheduler).elastic;
        };
        const double whole = deformed_energy(scene);
        EXPECT_NEAR(deformed_energy(divided(scene, cut)), whole, 1e-12 * whole);
        EXPECT_NEAR(deformed_energy(divided(scene, cut, Fronts::blended)), whole, 1e-12 * whole);
    }
}

// A cut that goes right through leaves nothing to blend.
TEST(Front, NothingOpensWhereNoCutEnds) {
    CutMesh cut(mesh::box({.cells = {4, 4, 4}}));
    cut.cut(CutSurface::plane({0.3, 0, 0}, {1, 0.2, 0.1}));
    EXPECT_TRUE(mesh::lanes(cut, Fronts::blended).opened_from.empty());
}

// Where several cuts end around a node, all parts of a copy may lie on one side of the plane that it would open along.
TEST(Front, EveryCopyHasALaneHoweverManyCutsEndThere) {
    int opening = 0;
    for (int seed = 0; seed < 200; ++seed) {
        std::mt19937 bits(static_cast<unsigned>(seed));
        const auto random = [&bits] { return static_cast<double>(bits() >> 8) * 0x1p-24; };
        CutMesh cut(mesh::box({.cells = {2, 2, 2}, .split = seed % 2 == 0 ? mesh::Split::five : mesh::Split::six}));
        for (int k = 0; k < 5; ++k) {
            const Point border{0.3 + 0.4 * random(), 0.3 + 0.4 * random(), 0.3 + 0.4 * random()};
            cut.cut(CutSurface::half_plane(border, {random() - 0.5, random() - 0.5, 1}, {random() - 0.5, 1, 0}));
        }
        const mesh::Lanes lanes = mesh::lanes(cut, Fronts::blended);
        std::vector<double> share(lanes.node_of_copy.size(), 0.0);
        for (const mesh::Lanes::Lane& lane : lanes.lanes) {
            for (const std::int32_t copy : lane.copies) {
                share[static_cast<std::size_t>(copy)] += lane.moments.fraction;
            }
        }
        for (const double value : share) EXPECT_GT(value, 0) << seed;
        opening += static_cast<int>(lanes.opened_from.size());
    }
    EXPECT_GT(opening, 0);
}

/// A body that nothing holds, without gravity, sheared and turning.
runtime::CuttableBody free_box(const mesh::TetMesh& mesh, const runtime::Settings& settings,
                               runtime::Scheduler& scheduler, const runtime::CutOptions& options) {
    runtime::Scene scene;
    scene.mesh = mesh;
    scene.gravity = {0, 0, 0};
    runtime::CuttableBody body(scene, settings, scheduler, options);
    std::vector<Point> velocities;
    for (const Point& x : mesh.nodes()) velocities.push_back({0.1 * std::sin(9 * x[1]), x[0], -0.4 * x[2]});
    body.body().set_velocities(velocities);
    return body;
}

struct MassAndMomentum {
    double mass = 0;
    Point momentum{};
};
MassAndMomentum mass_and_momentum(const runtime::DeformableBody& body) {
    std::vector<Point> velocities(body.nodes());
    body.velocities(velocities);
    MassAndMomentum sum;
    for (std::size_t node = 0; node < velocities.size(); ++node) {
        const double mass = body.nodal_mass(static_cast<std::int32_t>(node));
        sum.mass += mass;
        for (std::size_t axis = 0; axis < 3; ++axis) sum.momentum[axis] += mass * velocities[node][axis];
    }
    return sum;
}

TEST(Front, ABodyWithABlendedFrontKeepsItsMomentumAndComesApart) {
    runtime::Settings settings;
    settings.scalar = runtime::ScalarMode::double_precision;
    settings.time_step = 0.005;
    settings.conjugate_gradients = {.iterations = 300, .tolerance = 1e-13};
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    runtime::CuttableBody body = free_box(mesh::box({.cells = {8, 2, 2}, .size = {0.8, 0.2, 0.2}}), settings,
                                          *scheduler, {.fronts = Fronts::blended});
    const auto momentum = [&] {
        const MassAndMomentum now = mass_and_momentum(body.body());
        EXPECT_NEAR(now.mass, 32, 1e-11);
        return now.momentum;
    };
    const Point start = momentum();
    std::size_t most = 0;
    for (int stroke = 0; stroke < 12; ++stroke) {
        // Strokes share their ends exactly: between places that differ by rounding the body would hang together.
        const double from = 0.21 - 0.02 * stroke, to = 0.21 - 0.02 * (stroke + 1);
        body.cut(*scheduler,
                 CutSurface::swept(std::vector<std::array<Point, 2>>{{Point{0.33, from, -1}, Point{0.33, from, 1}},
                                                                     {Point{0.33, to, -1}, Point{0.33, to, 1}}}),
                 runtime::Configuration::rest);
        most = std::max(most, body.body().nodes() - body.mesh().node_of_copy().size());
        EXPECT_FALSE(body.step(*scheduler).lost);
        const Point now = momentum();
        for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(now[axis], start[axis], 1e-8);
    }
    EXPECT_GT(most, 0U);
    EXPECT_EQ(body.body().nodes(), body.mesh().node_of_copy().size());  // it has come apart: nothing opens any more
    EXPECT_EQ(mesh::components(body.mesh().node_of_copy().size(), body.mesh().parts()).count, 2);
}

// A cut across a front closes what was half open, whose mass goes back to the copy that it opened from.
TEST(Front, CutsAcrossBlendedFrontsKeepMomentum) {
    runtime::Settings settings;
    settings.scalar = runtime::ScalarMode::double_precision;
    settings.time_step = 0.005;
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    for (const double room : {0.0, 1.0}) {
        SCOPED_TRACE("room " + std::to_string(room));
        runtime::CuttableBody body = free_box(mesh::box({.cells = {4, 2, 2}, .size = {0.4, 0.2, 0.2}}), settings,
                                              *scheduler, {.fronts = Fronts::blended, .room = room});
        std::mt19937 random(5);
        std::uniform_real_distribution<double> unit(-1, 1);
        for (int cut = 0; cut < 12; ++cut) {
            for (int step = 0; step < 3; ++step) EXPECT_FALSE(body.step(*scheduler).lost);
            const auto vector = [&](double size) {
                return Point{size * unit(random), size * unit(random), size * unit(random)};
            };
            const Point shift = vector(0.1), first = vector(0.2), second = vector(0.2);
            const Point corner{0.2 + 1.5 * shift[0], 0.1 + shift[1], 0.1 + shift[2]};
            const Point before = mass_and_momentum(body.body()).momentum;
            body.cut(*scheduler, CutSurface::parallelogram(corner, first, second), runtime::Configuration::rest);
            const Point after = mass_and_momentum(body.body()).momentum;
            // Some hundreds of terms of a kilogram times a metre a second and less, up to rounding.
            for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(after[axis], before[axis], 1e-13) << cut;
        }
        EXPECT_GT(body.body().nodes(), body.mesh().node_of_copy().size());
    }
}

}  // namespace
}  // namespace lancet::test
