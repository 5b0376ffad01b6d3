#pragma once

#include <span>
#include <vector>

namespace lancet::experiments::precision {

/// A point of a work-precision diagram.
struct TimeAndError {
    double seconds = 0;
    double error = 0;
};

/// The share of its error by which a point must be better than every faster one to be worth its time: less than that
/// is noise of rounding and of solves that end by chance a little below their tolerance.
inline constexpr double worthwhile_gain = 0.01;

/// Which points are on the Pareto front: those that no other point beats, being faster with an error that is not larger
/// by more than `gain` of it, or as fast and more accurate. Equal points are on it together; a point with a number that
/// is not finite never is. gain = 0 is the front as textbooks have it.
[[nodiscard]] std::vector<bool> pareto_front(std::span<const TimeAndError> points, double gain = worthwhile_gain);

}  // namespace lancet::experiments::precision
