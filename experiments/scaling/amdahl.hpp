#pragma once

#include <optional>
#include <span>

namespace lancet::experiments::scaling {

/// A time on a number of threads.
struct ThreadTime {
    int threads = 1;
    double time = 0;  ///< positive, in any unit
};

/// Amdahl's law (1967), t(p) = t(1) (s + (1 - s) / p), fitted to times.
struct AmdahlFit {
    double serial_fraction = 0;     ///< s; below 0 where threads help more than their number, as by their caches
    double standard_error = 0;      ///< of s, from the scatter of the times about the law
    double time_on_one_thread = 0;  ///< t(1) of the law
    /// 1 / s, what speed-ups tend to; missing where s is not above 0.
    [[nodiscard]] std::optional<double> highest_speedup() const;
};

/// The least sum of squared relative errors over serial and parallel part a = s t(1), b = (1 - s) t(1) of a + b / p,
/// for noise is in proportion to the time. Two unknowns need three different thread counts to show an uncertainty:
/// nothing is returned for fewer. Throws lancet::Error for thread counts below 1 and times that are not positive and
/// finite.
[[nodiscard]] std::optional<AmdahlFit> fit_amdahl(std::span<const ThreadTime> times);

}  // namespace lancet::experiments::scaling
