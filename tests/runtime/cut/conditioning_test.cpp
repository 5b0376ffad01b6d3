// Slivers cost no iterations and hide no errors: conjugate gradients on a cube with a cut inside, so near to a node
// that an element loses next to nothing.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"
#include "lancet/runtime/simulate/body.hpp"
#include "lancet/runtime/simulate/equilibrium.hpp"

namespace lancet::test {
namespace {

using mesh::Point;
using runtime::PreconditionerKind;
using runtime::ScalarMode;

struct Arithmetic {
    ScalarMode scalar;
    PreconditionerKind preconditioner;
    double tolerance;  ///< of the solver
};

std::string name_of(const ::testing::TestParamInfo<Arithmetic>& info) {
    std::string name =
        std::string(to_string(info.param.scalar)) + "_" + std::string(to_string(info.param.preconditioner));
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

/// Four cells a side, held at both ends of x.
runtime::Scene held_cube() {
    runtime::Scene scene;
    scene.mesh = mesh::box({.cells = {4, 4, 4}});
    for (const char* end : {"x_min", "x_max"}) {
        const auto nodes = scene.mesh.node_set(end);
        scene.fixed_nodes.insert(scene.fixed_nodes.end(), nodes.begin(), nodes.end());
    }
    return scene;
}

/// A tilted square of 0.7 inside; at distance 0 it holds the node in the middle. The node's elements lose the cube of
/// the distance, and the nodes beside are farther away.
mesh::CutMesh cut_beside_the_middle(const runtime::Scene& scene, double distance) {
    mesh::CutMesh cut(scene.mesh);
    cut.cut(mesh::CutSurface::parallelogram({0.5 + distance + 0.105, 0.15, 0.15}, {-0.07, 0.7, 0}, {-0.14, 0, 0.7}));
    return cut;
}

double thinnest(const mesh::CutMesh& cut) {
    double fraction = 1;
    for (std::size_t part = 0; part < cut.parts().size(); ++part) {
        fraction = std::min(fraction, cut.moments(static_cast<std::int32_t>(part)).fraction);
    }
    return fraction;
}

struct Solution {
    std::vector<Point> positions;
    int iterations;
};

Solution statics(const runtime::Scene& scene, const Arithmetic& arithmetic, double tolerance) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    runtime::EquilibriumSettings settings;
    settings.scalar = arithmetic.scalar;
    settings.preconditioner = arithmetic.preconditioner;
    settings.tolerance = tolerance;
    std::vector<Point> positions(scene.mesh.nodes().begin(), scene.mesh.nodes().end());
    const auto report = find_equilibrium(scene, settings, *scheduler, positions);
    EXPECT_EQ(report.end, runtime::EquilibriumEnd::converged) << report.explanation;
    return {positions, report.conjugate_gradient_iterations};
}

Solution step(const runtime::Scene& scene, const Arithmetic& arithmetic, double tolerance) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    runtime::Settings settings;
    settings.scalar = arithmetic.scalar;
    settings.preconditioner = arithmetic.preconditioner;
    settings.conjugate_gradients = {.iterations = 2000, .tolerance = tolerance};
    const auto body = make_body(scene, settings, *scheduler);
    const auto report = body->step(*scheduler);
    EXPECT_FALSE(report.lost);
    EXPECT_LT(report.conjugate_gradient_residual, tolerance);
    std::vector<Point> positions(body->nodes());
    body->positions(positions);
    return {positions, report.conjugate_gradient_iterations};
}

class Conditioning : public ::testing::TestWithParam<Arithmetic> {
  protected:
    template <class Solve>
    void check(const Solve& solve) {
        const runtime::Scene scene = held_cube();
        const int uncut = solve(scene, GetParam(), GetParam().tolerance).iterations;
        // From a cut through the middle of elements to one that takes 1e-14 and less of an element.
        for (const double distance : {0.125, 0.05, 0.02, 5e-3, 1e-3, 1e-4, 5e-6}) {
            const mesh::CutMesh cut = cut_beside_the_middle(scene, distance);
            SCOPED_TRACE("thinnest part " + std::to_string(std::log10(thinnest(cut))));
            const runtime::Scene parts = divided(scene, cut);
            ASSERT_GT(parts.mesh.nodes().size(), scene.mesh.nodes().size());
            const Solution found = solve(parts, GetParam(), GetParam().tolerance);
            EXPECT_LE(found.iterations, 1.5 * uncut);
            Arithmetic exact = GetParam();
            exact.scalar = ScalarMode::double_precision;
            const Solution reference = solve(parts, exact, 1e-12);
            double scale = 0, error = 0;
            for (std::size_t n = 0; n < found.positions.size(); ++n) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    const double right = reference.positions[n][axis];
                    scale = std::max(scale, std::abs(right - parts.mesh.nodes()[n][axis]));
                    error = std::max(error, std::abs(found.positions[n][axis] - right));
                }
            }
            // What is left of the residual is within the tolerance; it is the error up to the condition of the
            // preconditioned matrix, whose square root is below ten: it takes some tens of iterations.
            EXPECT_LE(error, 10 * GetParam().tolerance * scale);
        }
        EXPECT_LT(thinnest(cut_beside_the_middle(scene, 5e-6)), 1e-14);
    }
};

INSTANTIATE_TEST_SUITE_P(
    Arithmetics, Conditioning,
    ::testing::Values(Arithmetic{ScalarMode::single_precision, PreconditionerKind::block_jacobi, 1e-4},
                      Arithmetic{ScalarMode::single_precision, PreconditionerKind::coarse, 1e-4},
                      Arithmetic{ScalarMode::mixed, PreconditionerKind::block_jacobi, 1e-6},
                      Arithmetic{ScalarMode::mixed, PreconditionerKind::coarse, 1e-6},
                      Arithmetic{ScalarMode::double_precision, PreconditionerKind::block_jacobi, 1e-8},
                      Arithmetic{ScalarMode::double_precision, PreconditionerKind::coarse, 1e-8}),
    name_of);

TEST_P(Conditioning, OfTheStaticProblemDoesNotDependOnTheFraction) {
    check(statics);
}

TEST_P(Conditioning, OfADynamicStepDoesNotDependOnTheFraction) {
    check(step);
}

TEST(Preconditioning, WithoutAPreconditionerIsRefusedUnlessForced) {
    const runtime::Scene whole = held_cube();
    const runtime::Scene parts = divided(whole, cut_beside_the_middle(whole, 0.05));
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    runtime::Settings settings;
    settings.preconditioner = PreconditionerKind::none;
    EXPECT_THROW(make_body(parts, settings, *scheduler), Error);
    EXPECT_NO_THROW(make_body(whole, settings, *scheduler));
    settings.force_preconditioner = true;
    EXPECT_NO_THROW(make_body(parts, settings, *scheduler));
    // Explicit steps solve nothing.
    settings.force_preconditioner = false;
    settings.integrator = runtime::Integrator::central_differences;
    settings.energy_safeguard = false;
    settings.mass = runtime::MassKind::fraction;
    settings.time_step = 1e-4;
    EXPECT_NO_THROW(make_body(parts, settings, *scheduler));

    runtime::EquilibriumSettings statics_settings;
    statics_settings.preconditioner = PreconditionerKind::none;
    std::vector<Point> positions(parts.mesh.nodes().begin(), parts.mesh.nodes().end());
    EXPECT_THROW(find_equilibrium(parts, statics_settings, *scheduler, positions), Error);
    statics_settings.force_preconditioner = true;
    EXPECT_NO_THROW(find_equilibrium(parts, statics_settings, *scheduler, positions));
}

}  // namespace
}  // namespace lancet::test
