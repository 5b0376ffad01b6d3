#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "lancet/experiments/cutting/scenario.hpp"
#include "lancet/runtime/cut/cuttable_body.hpp"

namespace lancet::experiments::cutting {

/// What a run is computed with.
struct Arithmetic {
    runtime::OperatorKind matrix = runtime::OperatorKind::edge_blocks;
    runtime::ScalarMode scalar = runtime::ScalarMode::single_precision;
    kernels::InstructionSet instruction_set = kernels::active_instruction_set();
};

/// Conjugate gradients as an interactive program would use them: to a tolerance of 1e-3, once a step.
[[nodiscard]] runtime::Settings interactive_settings(const Arithmetic& arithmetic, double time_step);
/// The same steps, every one solved as well as double allows: what errors are against.
[[nodiscard]] runtime::Settings converged_settings(double time_step, kernels::InstructionSet instruction_set);

/// What a cut took.
struct CutTimes {
    double ms_geometry = 0, ms_topology = 0, ms_update = 0;
};

/// One step of a run, with the cut before it. Counts are those of the body after the cut.
struct Frame {
    int step = 0;     ///< 1 is the first
    double time = 0;  ///< s, at the end of the step
    std::int64_t cut_elements = 0, parts = 0;
    std::int64_t added_nodes = 0;  ///< copies, and those that open at blended fronts
    std::optional<CutTimes> cut{};
    double ms_step = 0, ms_solve = 0;
    int cg_iterations = 0;
    std::vector<Point> positions{};  ///< of all copies, without those that open at blended fronts
    std::vector<double> mass{};      ///< of the same, kg
};

/// Looks at the body after a step; 0: before the first step and its cuts.
using Observer = std::function<void(int step, const runtime::CuttableBody& body)>;

/// Runs a scenario. Throws CheckFailed where a step is lost or a place is not finite.
[[nodiscard]] std::vector<Frame> run(const Scenario& scenario, const runtime::Settings& settings,
                                     runtime::Scheduler& scheduler, const Observer& observe = {},
                                     mesh::Fronts fronts = mesh::Fronts::sharp);

/// The elements that consist of more than one part.
[[nodiscard]] std::int64_t count_cut_elements(const mesh::CutMesh& mesh);

/// |x - x_ref| / |x_ref - X| in the L2 norm with lumped masses, over the copies; `rest` are their places at rest.
/// Nothing where the reference has not moved. Throws CheckFailed where the copies are not as many.
[[nodiscard]] std::optional<double> error_l2(const Frame& found, const Frame& reference, std::span<const Point> rest);

/// The smallest value of a frame over repetitions: every repetition does the same, and whatever else runs on the
/// machine can only lengthen its times.
[[nodiscard]] double shortest(const std::vector<std::vector<Frame>>& repetitions, std::size_t frame,
                              const std::function<double(const Frame&)>& value);

/// A time of a run.
struct Timing {
    double median = 0;         ///< over the frames, of the shortest of each
    double noise_percent = 0;  ///< (largest - smallest) / median of the repetitions' medians over their frames
};
[[nodiscard]] Timing timing(const std::vector<std::vector<Frame>>& repetitions,
                            const std::function<double(const Frame&)>& value);

}  // namespace lancet::experiments::cutting
