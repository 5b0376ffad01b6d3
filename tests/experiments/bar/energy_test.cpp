#include "lancet/experiments/bar/energy.hpp"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::bar {
namespace {

Problem small_box() {
    ProblemOptions options;
    options.cells = {3, 2, 2};
    options.size = {0.6, 0.4, 0.5};
    return make_problem(options);
}

std::vector<double> scaled(const Problem& problem, double x, double y, double z) {
    std::vector<double> positions;
    for (const mesh::Point& p : problem.mesh.nodes()) positions.insert(positions.end(), {x * p[0], y * p[1], z * p[2]});
    return positions;
}

TEST(LumpedMasses, AddUpToTheMassOfTheBody) {
    const Problem problem = small_box();
    const auto masses = lumped_masses(problem);
    EXPECT_NEAR(std::accumulate(masses.begin(), masses.end(), 0.0), 100 * 0.6 * 0.4 * 0.5, 1e-12);
}

TEST(Energy, OfFreeFallIsThatOfAPoint) {
    const Problem problem = small_box();
    auto positions = scaled(problem, 1, 1, 1);
    std::vector<double> velocities(positions.size(), 0.0);
    for (std::size_t node = 0; node < problem.mesh.nodes().size(); ++node) {
        positions[3 * node + 1] -= 2.0;
        velocities[3 * node] = 3.0;
    }
    const double mass = 100 * 0.6 * 0.4 * 0.5;
    const Energy result = energy(problem, positions, velocities);
    EXPECT_NEAR(result.kinetic, mass * 4.5, 1e-10);
    EXPECT_NEAR(result.gravitational, -mass * 9.81 * 2, 1e-10);
    EXPECT_NEAR(result.elastic, 0, 1e-12);
    EXPECT_DOUBLE_EQ(result.total(), result.kinetic + result.elastic + result.gravitational);
}

TEST(Energy, OfStretchAndOfAMirrorImageFollowsTheFormula) {
    const Problem problem = small_box();
    const double volume = 0.6 * 0.4 * 0.5;
    const double mu = problem.young_modulus / (2 * (1 + problem.poisson_ratio));
    const double lambda = 2 * mu * problem.poisson_ratio / (1 - 2 * problem.poisson_ratio);
    const std::vector<double> still(3 * problem.mesh.nodes().size(), 0.0);
    const auto expected = [&](double a, double b, double c) {
        const double trace = a + b + c - 3;
        return volume * (mu * ((a - 1) * (a - 1) + (b - 1) * (b - 1) + (c - 1) * (c - 1)) + lambda / 2 * trace * trace);
    };
    EXPECT_NEAR(energy(problem, scaled(problem, 1.5, 0.8, 1.1), still).elastic, expected(1.5, 0.8, 1.1), 1e-9);
    // The nearest rotation to a mirror image turns about the smallest stretch: that one counts as negative.
    EXPECT_NEAR(energy(problem, scaled(problem, 1.5, -0.8, 1.1), still).elastic, expected(1.5, -0.8, 1.1), 1e-9);
    EXPECT_NEAR(energy(problem, scaled(problem, 0, 0, 0), still).elastic, expected(0, 0, 0), 1e-9);
    const double tiny = 1e-9;
    EXPECT_NEAR(energy(problem, scaled(problem, 1 + tiny, 1, 1), still).elastic,
                volume * (mu + lambda / 2) * tiny * tiny, 1e-6 * volume * mu * tiny * tiny);
}

TEST(Energy, RefusesStatesOfAnotherSize) {
    const Problem problem = small_box();
    const auto positions = scaled(problem, 1, 1, 1);
    EXPECT_THROW((void)energy(problem, positions, {}), Error);
}

}  // namespace
}  // namespace lancet::experiments::bar
