#pragma once

#include <vector>

#include "lancet/experiments/collision/row.hpp"
#include "lancet/experiments/collision/scene.hpp"
#include "lancet/experiments/collision/settings.hpp"
#include "lancet/experiments/common/progress.hpp"

namespace lancet::experiments::collision {

/// Moves a scene step by step, and lets all kinds find what touches in each: one after the other in each step, so that
/// whatever else the machine does falls on all. Throws CheckFailed if two kinds do not find the same pairs or contacts.
[[nodiscard]] std::vector<Row> measure(const Scene& scene, const CollisionSettings& settings,
                                       runtime::Scheduler& scheduler, Progress& progress);

}  // namespace lancet::experiments::collision
