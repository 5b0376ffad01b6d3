#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "lancet/kernels/layout/row_pattern_changes.hpp"

namespace lancet::runtime {

/// What a change of some elements changes in the layout of a body, by internal numbers.
struct LayoutChange {
    struct NodalMass {
        std::int32_t node = 0;
        double mass = 0;  ///< row sum, kilograms
        /// For a consistent mass: the masses int rho phi_i phi_j with other nodes.
        std::vector<std::pair<std::int32_t, double>> row{};
    };

    std::vector<kernels::ElementMove> moves{};
    std::vector<NodalMass> masses{};  ///< of all nodes whose mass is another
};

}  // namespace lancet::runtime
