#include "lancet/experiments/cutting/run.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "lancet/experiments/common/main.hpp"
#include "lancet/experiments/common/statistics.hpp"
#include "lancet/runtime/observe/clock.hpp"

namespace lancet::experiments::cutting {
namespace {

/// Cuts along all strokes that are due.
std::optional<CutTimes> cut_before(int step, const Scenario& scenario, runtime::CuttableBody& body,
                                   runtime::Scheduler& scheduler) {
    std::optional<CutTimes> times;
    for (const Stroke& stroke : scenario.strokes) {
        if (stroke.step != step - 1) continue;
        const runtime::CutUpdate update =
            body.cut(scheduler, stroke.surface, runtime::Configuration::rest, stroke.front);
        if (!times) times = CutTimes{};
        times->ms_geometry += 1e3 * update.mesh.seconds_geometry;
        times->ms_topology += 1e3 * update.mesh.seconds_topology;
        times->ms_update += 1e3 * update.seconds_update;
    }
    return times;
}

}  // namespace

runtime::Settings interactive_settings(const Arithmetic& arithmetic, double time_step) {
    runtime::Settings settings;
    settings.time_step = time_step;
    settings.scalar = arithmetic.scalar;
    settings.matrix = arithmetic.matrix;
    settings.instruction_set = arithmetic.instruction_set;
    settings.conjugate_gradients = {.iterations = 200, .tolerance = 1e-3};
    return settings;
}

runtime::Settings converged_settings(double time_step, kernels::InstructionSet instruction_set) {
    runtime::Settings settings;
    settings.time_step = time_step;
    settings.scalar = runtime::ScalarMode::double_precision;
    settings.instruction_set = instruction_set;
    settings.conjugate_gradients = {.iterations = 2000, .tolerance = 1e-6};
    settings.newton_iterations = 40;
    // Far below every error of the table.
    settings.newton_tolerance = 1e-8;
    return settings;
}

std::int64_t count_cut_elements(const mesh::CutMesh& mesh) {
    const auto elements = mesh.mesh().tetrahedra().size();
    std::vector<std::int32_t> cut(mesh.element_of_part().begin() + static_cast<std::ptrdiff_t>(elements),
                                  mesh.element_of_part().end());
    std::ranges::sort(cut);
    return std::distance(cut.begin(), std::ranges::unique(cut).begin());
}

std::vector<Frame> run(const Scenario& scenario, const runtime::Settings& settings, runtime::Scheduler& scheduler,
                       const Observer& observe, mesh::Fronts fronts) {
    runtime::CuttableBody body(scenario.scene, settings, scheduler, {.fronts = fronts});
    if (observe) observe(0, body);
    std::vector<Frame> frames;
    for (int step = 1; step <= scenario.steps; ++step) {
        Frame frame;
        frame.step = step;
        frame.cut = cut_before(step, scenario, body, scheduler);
        body.body().reset_totals();
        const double start = runtime::steady_seconds();
        const runtime::StepReport report = body.step(scheduler);
        frame.ms_step = 1e3 * (runtime::steady_seconds() - start);
        frame.ms_solve = 1e3 * body.body().totals().seconds_solve;
        frame.cg_iterations = report.conjugate_gradient_iterations;
        frame.time = body.body().time();
        frame.cut_elements = count_cut_elements(body.mesh());
        frame.parts = static_cast<std::int64_t>(body.mesh().parts().size());
        frame.added_nodes = static_cast<std::int64_t>(body.body().nodes() - body.mesh().mesh().nodes().size());
        frame.positions.resize(body.body().nodes());
        body.body().positions(frame.positions);
        frame.positions.resize(body.mesh().node_of_copy().size());
        for (std::size_t copy = 0; copy < frame.positions.size(); ++copy) {
            frame.mass.push_back(body.body().nodal_mass(static_cast<std::int32_t>(copy)));
        }
        const bool is_finite = std::ranges::all_of(frame.positions, [](const Point& p) {
            return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
        });
        if (report.lost || !is_finite) {
            throw CheckFailed(scenario.name + ": step " + std::to_string(step) + " found no finite state");
        }
        if (observe) observe(step, body);
        frames.push_back(std::move(frame));
    }
    return frames;
}

std::optional<double> error_l2(const Frame& found, const Frame& reference, std::span<const Point> rest) {
    if (found.positions.size() != reference.positions.size() || rest.size() < found.positions.size()) {
        throw CheckFailed("step " + std::to_string(found.step) + ": the run has " +
                          std::to_string(found.positions.size()) + " copies of nodes, its reference " +
                          std::to_string(reference.positions.size()));
    }
    double difference = 0, norm = 0;
    for (std::size_t copy = 0; copy < found.positions.size(); ++copy) {
        const double mass = reference.mass[copy];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double place = reference.positions[copy][axis];
            difference += mass * std::pow(found.positions[copy][axis] - place, 2);
            norm += mass * std::pow(place - rest[copy][axis], 2);
        }
    }
    if (norm == 0) return std::nullopt;
    return std::sqrt(difference / norm);
}

double shortest(const std::vector<std::vector<Frame>>& repetitions, std::size_t frame,
                const std::function<double(const Frame&)>& value) {
    double result = value(repetitions.front()[frame]);
    for (const std::vector<Frame>& frames : repetitions) result = std::min(result, value(frames[frame]));
    return result;
}

Timing timing(const std::vector<std::vector<Frame>>& repetitions, const std::function<double(const Frame&)>& value) {
    std::vector<double> best, medians;
    for (std::size_t frame = 0; frame < repetitions.front().size(); ++frame) {
        best.push_back(shortest(repetitions, frame, value));
    }
    for (const std::vector<Frame>& frames : repetitions) {
        std::vector<double> values;
        for (const Frame& frame : frames) values.push_back(value(frame));
        medians.push_back(median(values));
    }
    const Summary summary = summarize(medians);
    return {median(best), summary.median > 0 ? 100 * (summary.maximum - summary.minimum) / summary.median : 0};
}

}  // namespace lancet::experiments::cutting
