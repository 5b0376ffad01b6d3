#include "lancet/experiments/bar/errors.hpp"

#include <cmath>
#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::bar {

double error_percent(const Problem& problem, std::span<const double> positions, std::span<const double> reference) {
    if (positions.size() != reference.size() || positions.size() != 3 * problem.mesh.nodes().size()) {
        throw Error("error of a state: " + std::to_string(positions.size()) + " and " +
                    std::to_string(reference.size()) + " numbers found, expected " +
                    std::to_string(3 * problem.mesh.nodes().size()));
    }
    double sum = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        sum += (positions[i] - reference[i]) * (positions[i] - reference[i]);
    }
    return 100 * std::sqrt(3 * sum / static_cast<double>(positions.size())) / problem.length;
}

std::vector<double> error_times(const Problem& problem) {
    std::vector<double> times;
    for (const double time : {1.0, 5.0}) {
        const double step = std::round(time / problem.time_step);
        if (step <= problem.steps && std::abs(step * problem.time_step - time) <= 1e-6 * problem.time_step) {
            times.push_back(time);
        }
    }
    return times;
}

Errors errors_of(const Problem& problem, const Reference& reference, const std::vector<std::vector<double>>& snapshots,
                 std::span<const double> rest) {
    Errors errors;
    for (std::size_t i = 0; i < reference.times.size() && i < snapshots.size(); ++i) {
        const bool first = reference.times[i] == 1.0;
        if (!reference.positions.empty()) {
            (first ? errors.t1 : errors.t5) = error_percent(problem, snapshots[i], reference.positions[i]);
        }
        if (first && !reference.positions_t1_dt0.empty()) {
            errors.t1_dt0 = error_percent(problem, snapshots[i], reference.positions_t1_dt0);
        }
    }
    if (!rest.empty() && !reference.positions_rest.empty()) {
        errors.rest = error_percent(problem, rest, reference.positions_rest);
    }
    return errors;
}

}  // namespace lancet::experiments::bar
