#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "lancet/mesh/tet_mesh.hpp"
#include "lancet/runtime/solve/elastic_elements.hpp"

namespace lancet::experiments::cutting {

using mesh::Point;

/// The solution of a case of the Beam cut benchmark that an independent code found.
struct BeamReference {
    static constexpr std::size_t samples = 88;

    std::string_view load;  ///< 1, 2T or 3T
    runtime::ElementModel model;
    double energy;                                        ///< elastic, J
    std::array<std::int32_t, 3 * samples> displacements;  ///< at the places of the samples, in 1e-7 m

    /// Where a sample is at rest, m: inside of the beam and not on the cut.
    [[nodiscard]] static Point place(std::size_t sample);
    [[nodiscard]] Point displacement(std::size_t sample) const;  ///< m
};

[[nodiscard]] std::span<const BeamReference> beam_references();

}  // namespace lancet::experiments::cutting
