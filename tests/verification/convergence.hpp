#pragma once

#include <array>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

namespace lancet::test {

/// A value on three meshes, each with half the cell size of the one before.
struct Convergence {
    std::array<double, 3> value;

    /// log2 of the ratio of the two changes; not a number where the values do not settle in one direction.
    double order() const { return std::log2((value[1] - value[0]) / (value[2] - value[1])); }
    /// Richardson's limit with the observed order.
    double limit() const { return value[2] + (value[2] - value[1]) / (std::exp2(order()) - 1); }
};

/// Expects the finest value within the reference's `digits` (relative) and 1.3 times the element's own extrapolated
/// error, the distance to Richardson's limit: the observed order still rises on these meshes, so that the limit is
/// overshot. Records value, limit and order for the report.
inline void expect_converges_to(const std::string& what, const Convergence& found, double reference, double digits) {
    const double own = std::abs(found.limit() - found.value[2]);
    const double error = std::abs(found.value[2] - reference);
    EXPECT_LE(error, digits * std::abs(reference) + 1.3 * own)
        << what << ": " << found.value[0] << ", " << found.value[1] << ", " << found.value[2] << ", in the limit "
        << found.limit() << ", of order " << found.order() << "; the reference is " << reference;
    EXPECT_LT(error, std::abs(found.value[0] - reference)) << what << " does not come nearer to the reference";
    std::array<char, 160> line{};
    std::snprintf(line.data(), line.size(), "%.6g, limit %.6g, order %.2f, reference %.6g, off by %.2f %%",
                  found.value[2], found.limit(), found.order(), reference, 100 * error / std::abs(reference));
    ::testing::Test::RecordProperty(what, line.data());
    std::printf("    %-24s %s\n", what.c_str(), line.data());
}

}  // namespace lancet::test
