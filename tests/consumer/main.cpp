#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <vector>

#include "lancet/kernels/error.hpp"
#include "lancet/kernels/isa/instruction_set.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/mesh/tet_mesh.hpp"
#include "lancet/runtime/cut/cuttable_body.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"
#include "lancet/runtime/simulate/body.hpp"
#include "lancet/runtime/simulate/simulation.hpp"

namespace {

bool is_near(double value, double expected) {
    return std::abs(value - expected) < 1e-12;
}

/// Calls into every library, so that all of them have to link.
int use_lancet() {
    const lancet::mesh::TetMesh mesh = lancet::mesh::box({.cells = {4, 2, 2}, .size = {2, 1, 1}});
    if (mesh.tetrahedra().size() != 80 || !is_near(mesh.volume(), 2)) {
        std::fprintf(stderr, "a box of 4 x 2 x 2 cells has %zu elements and volume %g\n", mesh.tetrahedra().size(),
                     mesh.volume());
        return 1;
    }
    if (!lancet::kernels::is_executable(lancet::kernels::active_instruction_set())) {
        std::fprintf(stderr, "the active instruction set cannot be executed\n");
        return 1;
    }
    std::array<int, 100> blocks{};
    auto scheduler = lancet::runtime::make_scheduler(lancet::runtime::default_scheduler, 2);
    scheduler->for_each_block(100, [&](int block) { blocks[static_cast<std::size_t>(block)] += block; });
    for (int block = 0; block < 100; ++block) {
        if (blocks[static_cast<std::size_t>(block)] != block) {
            std::fprintf(stderr, "block %d did not run once\n", block);
            return 1;
        }
    }
    lancet::runtime::Scene scene;
    scene.mesh = mesh;
    scene.materials = {{0, {.young_modulus = 1e5, .poisson_ratio = 0.3, .density = 100}}};
    const auto fixed = mesh.node_set("x_min");
    scene.fixed_nodes.assign(fixed.begin(), fixed.end());
    const auto body = lancet::runtime::make_body(scene, {.time_step = 0.02}, *scheduler);
    for (int step = 0; step < 10; ++step) body->step(*scheduler);
    std::vector<lancet::mesh::Point> positions(body->nodes());
    body->positions(positions);
    const double sag = mesh.nodes().back()[1] - positions.back()[1];
    // A clamped bar falls less than freely: g t^2 / 2 after 0.2 s.
    if (!(sag > 0.01 && sag < 0.25)) {
        std::fprintf(stderr, "the free end of the bar sank by %g m\n", sag);
        return 1;
    }
    lancet::runtime::CuttableBody cut(scene, {.time_step = 0.02}, *scheduler,
                                      {.fronts = lancet::mesh::Fronts::blended});
    const std::array<lancet::mesh::Point, 2> above{{{1.1, 2, -1}, {1.1, 2, 2}}}, below{{{1.1, 0.3, -1}, {1.1, 0.3, 2}}};
    cut.cut(*scheduler, lancet::mesh::CutSurface::swept(std::array{above, below}));
    cut.step(*scheduler);
    if (cut.mesh().node_of_copy().size() <= mesh.nodes().size()) {
        std::fprintf(stderr, "a cut separated nothing\n");
        return 1;
    }
    lancet::runtime::Simulation simulation(*scheduler, {.time_step = 0.02});
    const int bar =
        simulation.add_body({.name = "bar", .scene = scene, .settings = {.time_step = 0.02}, .can_be_cut = true});
    const int knife = simulation.add_tool({.name = "knife",
                                           .shape = lancet::runtime::SphereTool{.radius = 0.05},
                                           .blade = std::array<lancet::mesh::Point, 2>{{{0, 0, -1}, {0, 0, 2}}}});
    simulation.keep_surfaces();
    for (const double height : {2.0, -1.0}) {
        simulation.move(knife, {.position = {1.1, height, 0}}, lancet::runtime::ToolAction::cut);
        simulation.step();
    }
    simulation.finish();
    if (simulation.cut_statistics().copies == 0 || simulation.latest_surface(bar)->positions.empty()) {
        std::fprintf(stderr, "a knife went through a bar and left no trace\n");
        return 1;
    }
    try {
        (void)lancet::mesh::box({.cells = {0, 1, 1}});
    } catch (const lancet::Error& error) {
        std::printf("as expected: %s\n", error.what());
        return 0;
    }
    std::fprintf(stderr, "a box without cells was accepted\n");
    return 1;
}

}  // namespace

int main() {
    try {
        return use_lancet();
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 2;
    }
}
