#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "lancet/experiments/microbench/bent_bar.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::experiments {

/// What the scalar kernels in double compute for the later state of a bar, with rotations by singular value
/// decomposition. All are xyz_ nodal vectors in the internal numbering.
struct Reference {
    std::vector<double> force;         ///< N
    std::vector<double> product;       ///< A z, by edge blocks
    std::vector<double> block_jacobi;  ///< z after one VectorPass
    std::vector<double> coarse;
};

Reference make_reference(const BentBar& bar, runtime::Scheduler& scheduler);

/// |found - reference| / |reference| over the free nodes, in the Euclidean norm.
template <class Real>
double relative_error(const BentBar& bar, const Real* found, std::span<const double> reference) {
    double difference = 0, size = 0;
    for (std::size_t node = 0; node < static_cast<std::size_t>(bar.numbering.free_count); ++node) {
        if (bar.numbering.user_of_internal[node] < 0) continue;
        for (std::size_t i = 4 * node; i < 4 * node + 3; ++i) {
            const double error = static_cast<double>(found[i]) - reference[i];
            difference += error * error;
            size += reference[i] * reference[i];
        }
    }
    return std::sqrt(difference / size);
}

}  // namespace lancet::experiments
