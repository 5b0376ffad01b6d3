#include "lancet/runtime/solve/critical_step.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {

double critical_step(double largest_eigenvalue, double rayleigh_mass, double rayleigh_stiffness) {
    if (!(rayleigh_mass >= 0 && rayleigh_stiffness >= 0) || !std::isfinite(rayleigh_mass + rayleigh_stiffness)) {
        throw Error("critical step: damping " + std::to_string(rayleigh_mass) + " 1/s and " +
                    std::to_string(rayleigh_stiffness) + " s; expected numbers that are not negative");
    }
    if (!std::isfinite(largest_eigenvalue)) throw Error("critical step: the largest eigenvalue is not finite");
    if (largest_eigenvalue <= 0) return std::numeric_limits<double>::infinity();
    const double omega = std::sqrt(largest_eigenvalue);
    const double xi = (rayleigh_mass / omega + rayleigh_stiffness * omega) / 2;
    // sqrt(1 + xi^2) - xi without the cancellation.
    return 2 / omega / (std::sqrt(1 + xi * xi) + xi);
}

template <class Real>
LargestEigenvalue largest_eigenvalue(Scheduler& scheduler, Operator<Real>& stiffness,
                                     const kernels::NodeNumbering& numbering, const std::vector<double>& nodal_mass,
                                     double tolerance) {
    const auto nodes = static_cast<std::size_t>(numbering.free_count);
    std::vector<double> scale(nodes), start(4 * nodes, 0.0);
    std::mt19937_64 random(20070039);
    for (std::size_t node = 0; node < nodes; ++node) {
        scale[node] = nodal_mass[node] > 0 ? 1 / std::sqrt(nodal_mass[node]) : 0.0;
        if (scale[node] == 0) continue;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            start[4 * node + axis] = static_cast<double>(random() >> 11) * 0x1p-52 - 1;
        }
    }
    kernels::AlignedVector<Real> z(4 * static_cast<std::size_t>(numbering.node_count), Real(0));
    const auto product = [&](std::span<const double> x, std::span<double> y) {
        for (std::size_t i = 0; i < x.size(); ++i) z[i] = static_cast<Real>(scale[i / 4] * x[i]);
        stiffness.product(scheduler, z.data());
        scheduler.for_each_block(numbering.blocks(), [&](int block) { stiffness.merge(block); });
        for (std::size_t i = 0; i < y.size(); ++i) {
            y[i] = i % 4 == 3 ? 0.0 : scale[i / 4] * static_cast<double>(stiffness.buffer()[i]);
        }
    };
    LargestEigenvalue result = largest_eigenvalue(std::span<const double>(start), product, {.tolerance = tolerance});
    result.upper_bound *= 1 + 16 * static_cast<double>(std::numeric_limits<Real>::epsilon());
    return result;
}

template LargestEigenvalue largest_eigenvalue(Scheduler&, Operator<float>&, const kernels::NodeNumbering&,
                                              const std::vector<double>&, double);
template LargestEigenvalue largest_eigenvalue(Scheduler&, Operator<double>&, const kernels::NodeNumbering&,
                                              const std::vector<double>&, double);

}  // namespace lancet::runtime
