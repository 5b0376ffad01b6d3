#pragma once

#include <string>
#include <vector>

#include "lancet/experiments/common/progress.hpp"
#include "lancet/experiments/cutting/row.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::experiments::cutting {

/// The Beam cut benchmark: the box of 0.03 x 0.06 x 0.2 m, z = 0 held, cut x < 0.015 at z = 0.1. Case 1: gravity along
/// +x; cases 2T and 3T: tractions on strips of the top. Statics in double, on a sequence of `levels` meshes of 4 k, 8 k
/// and 26 k cells:
///
/// - aligned: the cut follows faces of elements;
/// - through elements: one more layer, so that the plane z = 0.1 halves the middle one; the front lies on faces;
/// - front retracts, front extends: one more row, too, so that the front lies inside of elements, which stay whole or
///   are cut right through; and with a blended front (mesh/cut/lanes.hpp), which is also taken where it lies on faces.
///
/// Errors are relative: the elastic energy, and the displacement in the root mean square over the samples of
/// beam_reference.hpp. Orders are in the cell size, taken from the number of unknowns.
[[nodiscard]] std::vector<Row> measure_beam_cut(const std::string& load, int levels, runtime::Scheduler& scheduler,
                                                Progress& progress);

}  // namespace lancet::experiments::cutting
