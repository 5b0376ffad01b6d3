#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "lancet/runtime/simulate/scene.hpp"

namespace lancet::runtime {

/// A small component of a cut body that nothing holds.
struct Crumb {
    std::int32_t component = 0;       ///< number in mesh::components of the divided scene's mesh
    std::vector<std::int32_t> nodes;  ///< of the divided scene
    double volume = 0;                ///< cubic metres
};

/// What becomes of crumbs.
enum class CrumbTreatment {
    keep,    ///< they fly
    freeze,  ///< they stay where they came off
    drop     ///< they stay there without weight or stiffness, as if they were not there
};
std::string_view to_string(CrumbTreatment treatment) noexcept;
/// Throws lancet::Error for a name that to_string does not give.
CrumbTreatment crumb_treatment_from_string(std::string_view name);

/// The components of a divided scene that have no more than `largest` of its volume, and no node that is fixed or
/// prescribed in any component; the largest first.
std::vector<Crumb> crumbs(const Scene& divided, double largest = 0.01);

/// Takes weight and stiffness from crumbs. Their nodes must be held: nothing else does.
void take_weight(Scene& divided, std::span<const Crumb> crumbs);

}  // namespace lancet::runtime
