#pragma once

#include "lancet/kernels/peak/peak_kernels.hpp"
#include "lancet/kernels/simd/pack.hpp"

namespace lancet::kernels {

/// Chains in flight: two pipes with a latency of up to six (where a multiply-add is two operations), and few enough for
/// sixteen registers.
inline constexpr int peak_chains = 12;

template <class P>
typename P::Real run_peak(long long iterations, typename P::Real multiplier, typename P::Real addend) {
    using Real = typename P::Real;
    const P factor(multiplier);
    const P term(addend);
    P chain[peak_chains];
    for (int c = 0; c < peak_chains; ++c) chain[c] = P(Real(1) + Real(c) / Real(64));
    for (long long iteration = 0; iteration < iterations; ++iteration) {
        for (int c = 0; c < peak_chains; ++c) chain[c] = fma(chain[c], factor, term);
    }
    Real total = 0;
    for (int c = 0; c < peak_chains; ++c) total += sum(chain[c]);
    return total / Real(peak_chains * P::width);
}

template <class P>
constexpr PeakKernels<typename P::Real> make_peak_kernels() {
    return {.operations_per_iteration = 2.0 * peak_chains * P::width, .run = &run_peak<P>};
}

}  // namespace lancet::kernels
