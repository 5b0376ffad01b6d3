#include "lancet/experiments/skips/measure.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "lancet/experiments/common/statistics.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::skips {
namespace {

bool same_bits(const std::vector<mesh::Point>& a, const std::vector<mesh::Point>& b) {
    return std::ranges::equal(a, b, [](const mesh::Point& p, const mesh::Point& q) {
        return std::bit_cast<std::array<std::uint64_t, 3>>(p) == std::bit_cast<std::array<std::uint64_t, 3>>(q);
    });
}

double rms_difference(const std::vector<mesh::Point>& a, const std::vector<mesh::Point>& b) {
    double square = 0;
    for (std::size_t node = 0; node < a.size(); ++node) {
        for (std::size_t axis = 0; axis < 3; ++axis) square += std::pow(a[node][axis] - b[node][axis], 2);
    }
    return std::sqrt(square / static_cast<double>(a.size()));
}

}  // namespace

Gain measure(const Item& item, int units, int repetitions) {
    constexpr double length = 4;  // m, of the Bar
    Gain gain{.same_bits = true};
    std::vector<double> all_with, all_without, ratios;
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        const auto with = item.with(), without = item.without();
        gain.bytes_with = with->bytes();
        gain.bytes_without = without->bytes();
        std::vector<double> units_with, units_without;
        for (int unit = 0; unit < units; ++unit) {
            double seconds_with = 0, seconds_without = 0;
            // Who comes second finds the caches as the first has left them: they change places.
            if (unit % 2 == 0) seconds_with = with->advance();
            seconds_without = without->advance();
            if (unit % 2 == 1) seconds_with = with->advance();
            all_with.push_back(seconds_with);
            all_without.push_back(seconds_without);
            units_with.push_back(seconds_with);
            units_without.push_back(seconds_without);
        }
        // Not the median of the ratios: on a busy machine long units are interrupted more often than short ones.
        ratios.push_back(quantile(units_with, 0.25) / quantile(units_without, 0.25));
        const auto a = with->positions(), b = without->positions();
        if (a.size() != b.size()) throw Error(item.name + ": positions with and without differ in number");
        if (a.empty()) continue;
        gain.compares_motion = true;
        gain.same_bits = gain.same_bits && same_bits(a, b);
        gain.error_percent = std::max(gain.error_percent, 100 * rms_difference(a, b) / length);
    }
    gain.ms_with = 1e3 * quantile(all_with, 0.25);
    gain.ms_without = 1e3 * quantile(all_without, 0.25);
    const Summary summary = summarize(ratios);
    gain.ratio = summary.median;
    gain.lowest = summary.minimum;
    gain.highest = summary.maximum;
    return gain;
}

}  // namespace lancet::experiments::skips
