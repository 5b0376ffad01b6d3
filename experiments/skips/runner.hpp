#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "lancet/runtime/simulate/simulation.hpp"

namespace lancet::experiments::skips {

/// Something that is timed, one unit of work after the other.
class Runner {
  public:
    virtual ~Runner() = default;
    /// Does one unit and returns the seconds it took.
    virtual double advance() = 0;
    /// Of all nodes now, to be compared; empty where there is nothing to compare.
    virtual std::vector<mesh::Point> positions() = 0;
    /// Of what it keeps, where that is known.
    virtual std::optional<double> bytes() const { return {}; }
};

/// The scheduler of all runners: one thread, for times that say what is computed and not how it is distributed.
runtime::Scheduler& one_thread();

/// The Bar (Jerabkova 2007), 4 x 0.8 x 0.8 m, clamped at x = 0; with --quick of half as many cells along each axis.
runtime::Scene bar(bool is_quick);

/// Steps of a body, `before` called ahead of the first.
std::unique_ptr<Runner> run_body(const runtime::Scene& scene, const runtime::Settings& settings,
                                 const std::function<void(runtime::DeformableBody&)>& before = {});

/// Steps of a world, `steps` to a unit, after `settle` steps that are not timed. `describe` fills the world.
std::unique_ptr<Runner> run_world(const runtime::SimulationOptions& options,
                                  const std::function<void(runtime::Simulation&)>& describe, int steps = 1,
                                  int settle = 0);

/// Bytes of the heap that are in use.
std::size_t heap_bytes() noexcept;

}  // namespace lancet::experiments::skips
