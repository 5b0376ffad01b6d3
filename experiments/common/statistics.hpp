#pragma once

#include <cstddef>
#include <span>

namespace lancet::experiments {

/// The five numbers of a sample.
struct Summary {
    std::size_t count = 0;
    double minimum = 0;
    double lower_quartile = 0;
    double median = 0;
    double upper_quartile = 0;
    double maximum = 0;

    /// (upper - lower quartile) / median in percent: the noise of a set of timings. 0 when both are 0.
    [[nodiscard]] double spread_percent() const;
};

/// The quantile at `fraction` in [0, 1], interpolated linearly between order statistics (type 7 of Hyndman and Fan
/// 1996, the default of R and NumPy). Throws lancet::Error for an empty sample, for a value that is not finite, and for
/// a fraction outside of [0, 1].
[[nodiscard]] double quantile(std::span<const double> sample, double fraction);

/// quantile(sample, 0.5).
[[nodiscard]] double median(std::span<const double> sample);

/// All five numbers; throws as quantile() does.
[[nodiscard]] Summary summarize(std::span<const double> sample);

/// Result of the Mann-Whitney U test of two independent samples.
struct MannWhitney {
    double u = 0;                    ///< pairs (a, b) with a > b, ties counting one half
    double p_two_sided = 1;          ///< probability of a U at least as far from its mean if nothing differs
    double probability_greater = 0;  ///< u / (n_a n_b): chance that a value of `a` exceeds one of `b`
    bool exact = false;              ///< p from the permutation distribution; otherwise from the normal approximation
};

/// Mann-Whitney U test (Mann and Whitney 1947): do the timings `a` and `b` differ by more than noise? Up to 40 values
/// together the p-value is that of the exact permutation distribution of the mid-ranks, ties included; beyond it comes
/// from the normal approximation with tie and continuity correction. Throws lancet::Error for an empty sample or a
/// value that is not finite.
[[nodiscard]] MannWhitney mann_whitney(std::span<const double> a, std::span<const double> b);

}  // namespace lancet::experiments
