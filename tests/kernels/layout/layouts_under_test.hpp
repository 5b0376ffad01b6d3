#pragma once

#include <array>
#include <numeric>
#include <string>
#include <tuple>
#include <vector>

#include "tests/kernels/element/reference_solid.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/layout/element_batches.hpp"
#include "lancet/kernels/layout/row_pattern.hpp"

namespace lancet::test {

using kernels::NodeNumbering;
using kernels::ScatterStrategy;

inline std::vector<std::uint8_t> fixed_flags(const ReferenceSolid& solid) {
    std::vector<std::uint8_t> fixed(solid.nodes.size(), 0);
    for (const std::int32_t node : solid.fixed) fixed[node] = 1;
    return fixed;
}

inline NodeNumbering numbered(const ReferenceSolid& solid, const kernels::NumberingOptions& options) {
    std::vector<std::int32_t> rank(solid.nodes.size());
    std::iota(rank.begin(), rank.end(), 0);
    return kernels::number_nodes(solid.nodes, solid.tetrahedra, fixed_flags(solid), rank, options);
}

inline std::vector<kernels::ElasticParameters> parameters(const ReferenceSolid& solid) {
    std::vector<kernels::ElasticParameters> parameters;
    for (const ReferenceMaterial& m : solid.materials) parameters.push_back({m.lambda(), m.mu(), m.density});
    return parameters;
}

template <class Real>
kernels::ElementBatches<Real> batches_of(const ReferenceSolid& solid, const NodeNumbering& numbering,
                                         ScatterStrategy strategy, int width) {
    return kernels::make_element_batches<Real>(solid.nodes, solid.tetrahedra, solid.regions, parameters(solid),
                                               numbering, strategy, width);
}

/// A bar with many blocks of few nodes, one end of it fixed.
inline ReferenceSolid layout_solid() {
    ReferenceSolid solid = jittered_bar({9, 3, 2}, 0.1, 0.15, 1);
    fix_first_section(solid, {9, 3, 2});
    return solid;
}
inline constexpr kernels::NumberingOptions layout_options{.nodes_per_block = 20, .nodes_per_aggregate = 7};

inline constexpr std::array scatter_strategies{ScatterStrategy::private_copies, ScatterStrategy::coloring,
                                               ScatterStrategy::node_gather};

/// "node_gather_8", for strategies and batch widths.
inline std::string layout_name(const ::testing::TestParamInfo<std::tuple<ScatterStrategy, int>>& info) {
    std::string name(to_string(std::get<0>(info.param)));
    for (char& c : name) c = c == '-' ? '_' : c;
    return name + "_" + std::to_string(std::get<1>(info.param));
}

}  // namespace lancet::test
