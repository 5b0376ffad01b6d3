#pragma once

#include <span>

namespace lancet::runtime {

/// The loops whose speed measure_bandwidth reports, with the widest vector instructions of the machine (AVX where it
/// has them) and enough independent sums that memory, not arithmetic, is the limit.

/// Sum of all values.
double stream_sum(std::span<const double> values) noexcept;

/// result[i] = a[i] + factor * b[i]; all of one size.
void stream_triad(std::span<double> result, std::span<const double> a, std::span<const double> b,
                  double factor) noexcept;

}  // namespace lancet::runtime
