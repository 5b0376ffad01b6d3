#pragma once

#include <span>

#include "lancet/experiments/common/table.hpp"
#include "lancet/experiments/skips/measure.hpp"

namespace lancet::experiments::skips {

/// A row for each item: what was measured.
Table gain_table(std::span<const Item> items, std::span<const Gain> gains);
/// A row for what cannot be switched.
Table remark_table(std::span<const Remark> remarks);

}  // namespace lancet::experiments::skips
