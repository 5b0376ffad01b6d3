#include "lancet/experiments/precision/dynamic_problem.hpp"

namespace lancet::experiments::precision {

mesh::Box DynamicProblem::box(int level) const {
    mesh::Box result{.cells = options.cells, .size = options.size};
    for (int& cells : result.cells) cells <<= level;
    return result;
}

mesh::Point DynamicProblem::watched_point() const {
    return {options.size[0], options.size[1] / 2, options.size[2] / 2};
}

std::vector<DynamicProblem> dynamic_problems(bool quick) {
    DynamicProblem bar{.problem = "bar-dynamic", .options = {}, .implicit_steps = {}, .explicit_steps = {}};
    bar.duration = 1;
    bar.implicit_steps = {0.04, 0.02, 0.01, 0.005, 0.0025};
    bar.explicit_steps = {0.002, 0.001, 0.0005, 0.00025};
    bar.reference_step = 1.0 / 4000;

    DynamicProblem body{.problem = "tumbling", .options = {}, .implicit_steps = {}, .explicit_steps = {}};
    body.options.cells = {12, 8, 4};
    body.options.size = {0.3, 0.2, 0.1};
    body.options.density = 1000;
    body.options.gravity = {0, 0, 0};
    body.options.time_step = 0.02;
    body.is_held = false;
    body.spin = {3, 12, 8};
    body.duration = 0.6;                                       // a turn and a half
    body.integrator = runtime::Integrator::implicit_midpoint;  // implicit Euler stops a spinning body
    body.implicit_steps = {0.02, 0.01, 0.005, 0.0025, 0.00125};
    body.explicit_steps = {0.002, 0.001, 0.0005, 0.00025};
    body.reference_step = 1.0 / 8000;

    if (quick) {
        bar.options.cells = {20, 4, 4};
        body.options.cells = {6, 4, 2};
        for (DynamicProblem* problem : {&bar, &body}) {
            problem->implicit_steps.resize(3);
            problem->explicit_steps.resize(3);
            problem->reference_step *= 2;
        }
    }
    return {bar, body};
}

runtime::Scene scene_of(const DynamicProblem& problem, int level) {
    const bar::ProblemOptions& options = problem.options;
    runtime::Scene scene;
    scene.mesh = mesh::box(problem.box(level));
    scene.materials = {{0, {options.young_modulus, options.poisson_ratio, options.density}}};
    scene.gravity = options.gravity;
    if (problem.is_held) {
        const auto fixed = scene.mesh.node_set("x_min");
        scene.fixed_nodes.assign(fixed.begin(), fixed.end());
    }
    return scene;
}

std::vector<mesh::Point> start_velocities(const DynamicProblem& problem, const runtime::Scene& scene) {
    std::vector<mesh::Point> velocities;
    const auto& spin = problem.spin;
    for (const mesh::Point& p : scene.mesh.nodes()) {
        mesh::Point r = p;
        for (std::size_t axis = 0; axis < 3; ++axis) r[axis] -= problem.options.size[axis] / 2;
        velocities.push_back(
            {spin[1] * r[2] - spin[2] * r[1], spin[2] * r[0] - spin[0] * r[2], spin[0] * r[1] - spin[1] * r[0]});
    }
    return velocities;
}

}  // namespace lancet::experiments::precision
