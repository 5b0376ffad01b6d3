#pragma once

#include <cstddef>

#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::runtime {

/// Streaming bandwidth of all threads of a scheduler together, in GB/s (1e9 bytes a second).
struct Bandwidth {
    double read_gbytes_per_s = 0;   ///< sum of an array that fills the working set
    double triad_gbytes_per_s = 0;  ///< a = b + s c (McCalpin's STREAM), three arrays that fill the working set
};

/// Measures streaming bandwidth with every thread of `scheduler` on its own share of `working_set_bytes`, which it
/// touched first: the median of `repetitions` runs of some milliseconds each, caches warm. Bytes count as in STREAM,
/// what the loop names: 8 for each double read or written, without the line that a store may read before.
///
/// A working set below the cache size of the threads together measures that cache; memory takes several times the
/// last-level cache. Loops check their results, so that no part of them can be skipped.
/// Throws lancet::Error if the working set has less than 1,024 bytes for each thread, or repetitions < 1.
Bandwidth measure_bandwidth(Scheduler& scheduler, std::size_t working_set_bytes, int repetitions = 9);

}  // namespace lancet::runtime
