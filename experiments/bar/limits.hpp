#pragma once

namespace lancet::experiments::bar {

/// What one thread of this machine can do at most, measured here and now: what GFLOP/s and GB/s are to be compared
/// with.
struct MachineLimits {
    double peak_gflops_float = 0;  ///< multiply-adds of the active instruction set
    double peak_gflops_double = 0;
    double memory_gbytes_per_s = 0;  ///< reading 256 MiB
    double cache_gbytes_per_s = 0;   ///< reading 1 MiB
};

[[nodiscard]] MachineLimits measure_limits();

}  // namespace lancet::experiments::bar
