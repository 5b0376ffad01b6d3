#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"
#include "lancet/runtime/simulate/body.hpp"

namespace lancet::runtime {
namespace {

std::unique_ptr<DeformableBody> bar(Integrator integrator, bool has_floor, Scheduler& scheduler) {
    Scene scene{.mesh = mesh::box({.cells = {6, 2, 2}, .size = {0.6, 0.2, 0.2}}), .fixed_nodes = {}};
    if (has_floor) {
        scene.floor = Floor{.point = {0, -0.01, 0}, .normal = {0, 1, 0}};
    } else {
        for (std::int32_t node = 0; node < static_cast<std::int32_t>(scene.mesh.nodes().size()); ++node) {
            if (scene.mesh.nodes()[static_cast<std::size_t>(node)][0] == 0) scene.fixed_nodes.push_back(node);
        }
    }
    Settings settings;
    settings.integrator = integrator;
    settings.energy_safeguard = integrator == Integrator::implicit_euler;
    settings.time_step = is_explicit(integrator) ? 1e-4 : 0.02;
    return make_body(scene, settings, scheduler);
}

using Case = std::pair<Integrator, bool>;

class Stages : public testing::TestWithParam<Case> {};

TEST_P(Stages, OneByOneAreAStep) {
    const auto scheduler = make_scheduler(SchedulerKind::serial, 1);
    const auto whole = bar(GetParam().first, GetParam().second, *scheduler);
    const auto staged = bar(GetParam().first, GetParam().second, *scheduler);
    std::vector<Point> expected(whole->nodes()), found(whole->nodes());
    for (int step = 0; step < 12; ++step) {
        const StepReport report = whole->step(*scheduler);
        StepReport last;
        for (const StepStage stage : step_stages) last = staged->run(stage, *scheduler);
        EXPECT_EQ(last.conjugate_gradient_iterations, report.conjugate_gradient_iterations);
        whole->positions(expected);
        staged->positions(found);
        ASSERT_EQ(found, expected) << "after step " << step;
    }
    EXPECT_EQ(staged->time(), whole->time());
    EXPECT_EQ(staged->totals().steps, 12);
}

INSTANTIATE_TEST_SUITE_P(Integrators, Stages,
                         testing::Values(Case{Integrator::implicit_euler, false}, Case{Integrator::newmark, false},
                                         Case{Integrator::implicit_midpoint, false},
                                         Case{Integrator::central_differences, false},
                                         Case{Integrator::implicit_euler, true}),
                         [](const auto& tested) {
                             std::string name(to_string(tested.param.first));
                             for (char& c : name) c = c == '-' || c == ' ' ? '_' : c;
                             return name + (tested.param.second ? "_on_floor" : "");
                         });

}  // namespace
}  // namespace lancet::runtime
