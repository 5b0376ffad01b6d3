#pragma once

namespace lancet::kernels {

/// What the machine can do at most: multiply-adds that need no memory.
template <class Real>
struct PeakKernels {
    /// Arithmetic operations of one iteration, a multiply-add counted as two.
    double operations_per_iteration;

    /// Runs independent chains a <- a x multiplier + addend that stay in registers, `iterations` times each: as many as
    /// the pipes need to stay full. Chain c starts at 1 + c / 64 in every lane. Returns the sum of all chains and lanes
    /// over their number, so that no part can be skipped. With |multiplier| < 1 the values stay bounded.
    Real (*run)(long long iterations, Real multiplier, Real addend);
};

}  // namespace lancet::kernels
