#include "lancet/experiments/bar/limits.hpp"

#include <algorithm>
#include <cstddef>

#include "lancet/kernels/error.hpp"
#include "lancet/kernels/isa/kernel_set.hpp"
#include "lancet/runtime/observe/bandwidth.hpp"
#include "lancet/runtime/observe/clock.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::experiments::bar {
namespace {

template <class Real>
double peak_gflops() {
    const auto& peak = kernels::kernel_set<Real>(kernels::active_instruction_set()).peak;
    constexpr long long iterations = 100'000;  // about a millisecond
    double best = 0;
    for (int run = 0; run < 10; ++run) {
        const double start = runtime::steady_seconds();
        const Real result = peak.run(iterations, Real(0.5), Real(0.25));
        const double seconds = runtime::steady_seconds() - start;
        if (!(result == result)) throw Error("peak: the multiply-adds gave no number");  // and so they are not left out
        best = std::max(best, static_cast<double>(peak.operations_per_iteration) * 1e-9 * iterations / seconds);
    }
    return best;
}

}  // namespace

MachineLimits measure_limits() {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    constexpr std::size_t mebibyte = 1 << 20;
    return {.peak_gflops_float = peak_gflops<float>(),
            .peak_gflops_double = peak_gflops<double>(),
            .memory_gbytes_per_s = runtime::measure_bandwidth(*scheduler, 256 * mebibyte, 5).read_gbytes_per_s,
            .cache_gbytes_per_s = runtime::measure_bandwidth(*scheduler, mebibyte, 5).read_gbytes_per_s};
}

}  // namespace lancet::experiments::bar
