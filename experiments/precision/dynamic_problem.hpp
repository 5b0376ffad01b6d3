#pragma once

#include <array>
#include <string>
#include <vector>

#include "lancet/experiments/bar/problem.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/simulate/scene.hpp"
#include "lancet/runtime/simulate/settings.hpp"

namespace lancet::experiments::precision {

/// A corotational box in motion, undamped. SI units.
struct DynamicProblem {
    std::string problem;
    bar::ProblemOptions options;   ///< mesh, material and the longest time step
    bool is_held = true;           ///< at x = 0; else it is free
    std::array<double, 3> spin{};  ///< rad/s: it starts at rest in shape, turning like a rigid body about its centre
    double duration = 1;           ///< s
    /// What other choices are varied with, at the longest step.
    runtime::Integrator integrator = runtime::Integrator::implicit_euler;
    double reference_step = 1e-3;  ///< s, of the coarser of the two solutions that the reference is extrapolated from
    std::vector<double> implicit_steps, explicit_steps;  ///< s

    /// The box of the mesh, its cells doubled `level` times.
    [[nodiscard]] mesh::Box box(int level) const;
    /// Whose displacement tables show: the middle of the face x = length.
    [[nodiscard]] mesh::Point watched_point() const;
};

/// The Bar, hanging from the moment it is let go (Jerabkova 2007), and a free body that tumbles.
[[nodiscard]] std::vector<DynamicProblem> dynamic_problems(bool quick);

/// The scene of a problem on the mesh of a level.
[[nodiscard]] runtime::Scene scene_of(const DynamicProblem& problem, int level);

/// Velocities at the start, one for each node of the scene.
[[nodiscard]] std::vector<mesh::Point> start_velocities(const DynamicProblem& problem, const runtime::Scene& scene);

}  // namespace lancet::experiments::precision
