#include "lancet/experiments/precision/pareto.hpp"

#include <cmath>
#include <cstddef>

namespace lancet::experiments::precision {
namespace {

bool is_finite(const TimeAndError& point) {
    return std::isfinite(point.seconds) && std::isfinite(point.error);
}

bool beats(const TimeAndError& a, const TimeAndError& b, double gain) {
    if (a.seconds == b.seconds) return a.error < b.error;
    return a.seconds < b.seconds && a.error * (1 - gain) <= b.error;
}

}  // namespace

std::vector<bool> pareto_front(std::span<const TimeAndError> points, double gain) {
    std::vector<bool> front(points.size(), false);
    for (std::size_t i = 0; i < points.size(); ++i) {
        front[i] = is_finite(points[i]);
        for (const TimeAndError& other : points) {
            if (is_finite(other) && beats(other, points[i], gain)) front[i] = false;
        }
    }
    return front;
}

}  // namespace lancet::experiments::precision
