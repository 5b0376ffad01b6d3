#include "lancet/experiments/common/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments {
namespace {

void check_sample(std::span<const double> sample) {
    if (sample.empty()) throw Error("statistics of an empty sample: expected at least one value");
    for (std::size_t i = 0; i < sample.size(); ++i) {
        if (!std::isfinite(sample[i])) {
            throw Error("statistics: value " + std::to_string(i) + " of the sample is not a finite number");
        }
    }
}

std::vector<double> sorted(std::span<const double> sample) {
    check_sample(sample);
    std::vector<double> values(sample.begin(), sample.end());
    std::sort(values.begin(), values.end());
    return values;
}

double quantile_of_sorted(const std::vector<double>& values, double fraction) {
    const double place = fraction * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return std::lerp(values[below], values[above], place - static_cast<double>(below));
}

/// Twice the mid-rank (whole even with ties) of every value of the joined samples, in the order of the samples, and
/// the sum of t^3 - t over groups of t tied values.
struct Ranks {
    std::vector<std::int64_t> doubled;
    double tie_term = 0;
};

Ranks rank(std::span<const double> a, std::span<const double> b) {
    std::vector<double> values(a.begin(), a.end());
    values.insert(values.end(), b.begin(), b.end());
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return values[i] < values[j]; });

    Ranks ranks;
    ranks.doubled.resize(values.size());
    for (std::size_t begin = 0; begin < order.size();) {
        std::size_t end = begin + 1;
        while (end < order.size() && values[order[end]] == values[order[begin]]) ++end;
        for (std::size_t i = begin; i < end; ++i) {
            ranks.doubled[order[i]] = static_cast<std::int64_t>(begin + 1 + end);  // ranks begin + 1 ... end
        }
        const auto tied = static_cast<double>(end - begin);
        ranks.tie_term += tied * tied * tied - tied;
        begin = end;
    }
    return ranks;
}

/// Of all ways to choose `chosen` of the ranks, the share whose sum lies at least as far from the mean as `observed`.
double exact_p(const std::vector<std::int64_t>& doubled, std::size_t chosen, std::int64_t observed) {
    const std::int64_t total = std::accumulate(doubled.begin(), doubled.end(), std::int64_t{0});
    const auto sums = static_cast<std::size_t>(total) + 1;
    // ways[k][s]: how many choices of k ranks add up to s. Whole numbers below 2^53, so exact in double.
    std::vector<std::vector<double>> ways(chosen + 1, std::vector<double>(sums, 0.0));
    ways[0][0] = 1;
    for (const std::int64_t value : doubled) {
        const auto step = static_cast<std::size_t>(value);
        for (std::size_t k = chosen; k > 0; --k) {
            for (std::size_t s = sums - 1; s >= step; --s) ways[k][s] += ways[k - 1][s - step];
        }
    }
    // The mean of the sum is total * chosen / n; compared without division.
    const auto n = static_cast<std::int64_t>(doubled.size());
    const std::int64_t mean = total * static_cast<std::int64_t>(chosen);
    const std::int64_t distance = std::abs(observed * n - mean);
    double all = 0;
    double far = 0;
    for (std::size_t s = 0; s < sums; ++s) {
        all += ways[chosen][s];
        if (std::abs(static_cast<std::int64_t>(s) * n - mean) >= distance) far += ways[chosen][s];
    }
    return far / all;
}

double normal_p(double u, double size_a, double size_b, double tie_term) {
    const double n = size_a + size_b;
    const double variance = size_a * size_b / 12 * (n + 1 - tie_term / (n * (n - 1)));
    if (variance <= 0) return 1;  // all values are equal
    const double distance = std::max(0.0, std::abs(u - size_a * size_b / 2) - 0.5);
    return std::erfc(distance / std::sqrt(2 * variance));
}

}  // namespace

double Summary::spread_percent() const {
    const double range = upper_quartile - lower_quartile;
    return range == 0 ? 0 : 100 * range / std::abs(median);
}

double quantile(std::span<const double> sample, double fraction) {
    if (!(fraction >= 0 && fraction <= 1)) {
        throw Error("quantile: fraction " + std::to_string(fraction) + " found, expected one from 0 to 1");
    }
    return quantile_of_sorted(sorted(sample), fraction);
}

double median(std::span<const double> sample) {
    return quantile(sample, 0.5);
}

Summary summarize(std::span<const double> sample) {
    const std::vector<double> values = sorted(sample);
    return {.count = values.size(),
            .minimum = values.front(),
            .lower_quartile = quantile_of_sorted(values, 0.25),
            .median = quantile_of_sorted(values, 0.5),
            .upper_quartile = quantile_of_sorted(values, 0.75),
            .maximum = values.back()};
}

MannWhitney mann_whitney(std::span<const double> a, std::span<const double> b) {
    check_sample(a);
    check_sample(b);
    constexpr std::size_t exact_limit = 40;
    const Ranks ranks = rank(a, b);
    const std::int64_t doubled_sum = std::accumulate(
        ranks.doubled.begin(), ranks.doubled.begin() + static_cast<std::ptrdiff_t>(a.size()), std::int64_t{0});
    const auto size_a = static_cast<double>(a.size());
    const auto size_b = static_cast<double>(b.size());

    MannWhitney result;
    result.u = static_cast<double>(doubled_sum) / 2 - size_a * (size_a + 1) / 2;
    result.probability_greater = result.u / (size_a * size_b);
    result.exact = a.size() + b.size() <= exact_limit;
    result.p_two_sided = result.exact ? exact_p(ranks.doubled, a.size(), doubled_sum)
                                      : normal_p(result.u, size_a, size_b, ranks.tie_term);
    return result;
}

}  // namespace lancet::experiments
