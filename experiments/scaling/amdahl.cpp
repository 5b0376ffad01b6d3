#include "lancet/experiments/scaling/amdahl.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::scaling {

std::optional<double> AmdahlFit::highest_speedup() const {
    if (!(serial_fraction > 0)) return std::nullopt;
    return 1 / serial_fraction;
}

std::optional<AmdahlFit> fit_amdahl(std::span<const ThreadTime> times) {
    std::set<int> counts;
    for (const ThreadTime& entry : times) {
        if (entry.threads < 1 || !std::isfinite(entry.time) || !(entry.time > 0)) {
            throw Error("Amdahl's law: a time of " + std::to_string(entry.time) + " on " +
                        std::to_string(entry.threads) + " threads found, expected positive times on 1 or more");
        }
        counts.insert(entry.threads);
    }
    if (counts.size() < 3) return std::nullopt;

    // Minimise sum_i (a / t_i + b / (p_i t_i) - 1)^2: normal equations N (a, b)^T = r with u = 1 / t, v = 1 / (p t).
    double uu = 0, uv = 0, vv = 0, u1 = 0, v1 = 0;
    for (const auto& [threads, time] : times) {
        const double u = 1 / time, v = 1 / (threads * time);
        uu += u * u;
        uv += u * v;
        vv += v * v;
        u1 += u;
        v1 += v;
    }
    const double determinant = uu * vv - uv * uv;  // positive: the thread counts differ
    const double a = (vv * u1 - uv * v1) / determinant, b = (uu * v1 - uv * u1) / determinant;
    double squares = 0;
    for (const auto& [threads, time] : times) {
        const double error = (a + b / threads) / time - 1;
        squares += error * error;
    }
    // Covariance of (a, b) is variance N^-1; of s = a / (a + b) to first order with the gradient (b, -a) / (a + b)^2.
    const double variance = squares / static_cast<double>(times.size() - 2);
    const double sum = a + b;
    const double spread = (b * b * vv + 2 * a * b * uv + a * a * uu) / determinant;
    return AmdahlFit{.serial_fraction = a / sum,
                     .standard_error = std::sqrt(variance * std::max(spread, 0.0)) / (sum * sum),
                     .time_on_one_thread = sum};
}

}  // namespace lancet::experiments::scaling
