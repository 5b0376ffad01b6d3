#pragma once

#include "lancet/experiments/common/progress.hpp"
#include "lancet/experiments/scheduler/measured.hpp"
#include "lancet/experiments/scheduler/settings.hpp"

namespace lancet::experiments::scheduler {

/// Measures all bars, schedulers and numbers of threads, each in processes of its own that take turns, so that a
/// disturbance of the machine meets all of them alike. Throws lancet::Error where a worker fails.
std::vector<Measured> measure_all(const SchedulerSettings& settings, Progress& progress);

}  // namespace lancet::experiments::scheduler
