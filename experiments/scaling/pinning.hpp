#pragma once

#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::experiments::scaling {

/// Holds every thread of a scheduler to one core, for as long as it lives: the k-th that comes to the k-th core this
/// process may use, round and round. The same for all schedulers: a loop with a body for each thread, of which each
/// asks Linux for its core (sched_setaffinity) and waits until all have come, so that no thread takes two of them.
/// Returns how many threads of the process have a core of their own, or share one, for good. Throws lancet::Error where
/// not all threads come, or the system refuses.
int pin_threads(runtime::Scheduler& scheduler);

}  // namespace lancet::experiments::scaling
