#pragma once

#include "lancet/runtime/observe/clock.hpp"

namespace lancet::runtime {

/// Divides the time of a step among its totals.
class StepTimer {
  public:
    /// Adds the seconds since the last call, or since construction.
    void add_to(double& total) {
        const double now = steady_seconds();
        total += now - mark_;
        mark_ = now;
    }

  private:
    double mark_ = steady_seconds();
};

}  // namespace lancet::runtime
