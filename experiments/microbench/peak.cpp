#include <string>

#include <benchmark/benchmark.h>

#include "lancet/experiments/microbench/subjects.hpp"
#include "lancet/kernels/isa/kernel_set.hpp"

namespace lancet::experiments {

namespace {

constexpr long long iterations = 10000;

/// Time of one round of the chains; the counter is what the others are to be compared with.
template <class Real>
void measure_peak(benchmark::State& state, kernels::InstructionSet set) {
    const auto& kernels = kernels::kernel_set<Real>(set);
    while (state.KeepRunningBatch(iterations)) {
        benchmark::DoNotOptimize(kernels.peak.run(iterations, Real(0.5), Real(0.25)));
    }
    const double operations = kernels.peak.operations_per_iteration * static_cast<double>(state.iterations());
    state.counters["gflops"] = benchmark::Counter(operations * 1e-9, benchmark::Counter::kIsRate);
    state.counters["lanes"] = kernels.width;
}

template <class Real>
void register_scalar(kernels::InstructionSet set) {
    const std::string name =
        std::string("peak/multiply-add/") + scalar_name<Real>() + "/" + std::string(kernels::to_string(set));
    benchmark::RegisterBenchmark(name.c_str(), [set](benchmark::State& state) { measure_peak<Real>(state, set); });
}

}  // namespace

void register_peak() {
    for (const kernels::InstructionSet set : instruction_sets_to_measure()) {
        register_scalar<float>(set);
        register_scalar<double>(set);
    }
}

}  // namespace lancet::experiments
