#pragma once

#include <vector>

#include "lancet/experiments/common/progress.hpp"
#include "lancet/experiments/cutting/row.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::experiments::cutting {

/// What a floor under the volume fractions of parts does (mesh::raise_fractions). A block held at both ends is cut in
/// two beside a layer of its nodes, so that the thinnest part has a given fraction of its element, and sags at rest;
/// for each fraction and each floor, the iterations of conjugate gradients and the errors against the block that is
/// cut along the layer. In double, so that nothing else is in the errors; where the cut is beside the layer is in them.
[[nodiscard]] std::vector<Row> measure_fraction_floor(runtime::Scheduler& scheduler, bool is_quick, Progress& progress);

}  // namespace lancet::experiments::cutting
