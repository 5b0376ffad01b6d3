#pragma once

#include <memory>

#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::runtime {

/// The schedulers behind make_scheduler, each defined in its own file; threads >= 1.
std::unique_ptr<Scheduler> make_serial();
std::unique_ptr<Scheduler> make_openmp(int threads);
std::unique_ptr<Scheduler> make_tbb(int threads);
std::unique_ptr<Scheduler> make_std_threads(int threads);

}  // namespace lancet::runtime
