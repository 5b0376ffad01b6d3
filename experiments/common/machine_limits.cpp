#include "lancet/experiments/common/machine_limits.hpp"

#include <algorithm>

#include "lancet/kernels/error.hpp"
#include "lancet/kernels/isa/kernel_set.hpp"
#include "lancet/runtime/observe/bandwidth.hpp"
#include "lancet/runtime/observe/clock.hpp"

namespace lancet::experiments {

template <class Real>
double MachineLimits::peak_gflops(kernels::InstructionSet instruction_set) {
    double& best = peaks_[{sizeof(Real), instruction_set}];
    if (best > 0) return best;
    const kernels::PeakKernels<Real>& peak = kernels::kernel_set<Real>(instruction_set).peak;
    constexpr long long iterations = 100'000;  // about a millisecond
    constexpr int runs = 10;
    const int threads = scheduler_->threads();
    const double operations = peak.operations_per_iteration * static_cast<double>(iterations) * threads;
    for (int run = 0; run < runs; ++run) {
        const double start = runtime::steady_seconds();
        scheduler_->for_each_block(threads, [&](int) {
            const Real result = peak.run(iterations, Real(0.5), Real(0.25));
            if (!(result == result)) throw Error("peak: the multiply-adds gave no number");  // so they are not left out
        });
        const double seconds = runtime::steady_seconds() - start;
        best = std::max(best, operations * 1e-9 / seconds);
    }
    return best;
}

template double MachineLimits::peak_gflops<float>(kernels::InstructionSet);
template double MachineLimits::peak_gflops<double>(kernels::InstructionSet);

double MachineLimits::read_gbytes_per_s(double bytes) {
    constexpr std::size_t least = 4096;
    const std::size_t working_set = std::max(static_cast<std::size_t>(bytes), least);
    const auto found = bandwidths_.find(working_set);
    if (found != bandwidths_.end()) return found->second;
    constexpr int repetitions = 5;
    return bandwidths_[working_set] =
               runtime::measure_bandwidth(*scheduler_, working_set, repetitions).read_gbytes_per_s;
}

}  // namespace lancet::experiments
