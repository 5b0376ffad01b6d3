#pragma once

#include <span>

#include "lancet/experiments/common/table.hpp"
#include "lancet/experiments/scheduler/verdict.hpp"

namespace lancet::experiments::scheduler {

/// A row for each form of the step.
Table form_table(std::span<const Measured> rows);
/// A row for each aim.
Table target_table(std::span<const Target> targets);

}  // namespace lancet::experiments::scheduler
