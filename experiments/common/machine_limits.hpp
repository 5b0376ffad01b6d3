#pragma once

#include <cstddef>
#include <map>
#include <utility>

#include "lancet/kernels/isa/instruction_set.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::experiments {

/// What this machine can do at most on the threads of a scheduler; each limit is measured when it is first asked for.
class MachineLimits {
  public:
    /// `scheduler` must outlive this.
    explicit MachineLimits(runtime::Scheduler& scheduler) : scheduler_(&scheduler) {}

    /// Multiply-adds of one instruction set, in 1e9 operations a second: the best of several short runs, of all threads
    /// together.
    template <class Real>
    double peak_gflops(kernels::InstructionSet instruction_set);

    /// Reading `bytes` again and again, in 1e9 bytes a second: the limit of the cache, or the memory, that holds them.
    double read_gbytes_per_s(double bytes);

  private:
    runtime::Scheduler* scheduler_;
    std::map<std::pair<std::size_t, kernels::InstructionSet>, double> peaks_;  ///< by size of the scalar
    std::map<std::size_t, double> bandwidths_;                                 ///< by bytes
};

}  // namespace lancet::experiments
