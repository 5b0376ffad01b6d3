#include "lancet/experiments/pipeline/interactive.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <utility>

#include "lancet/experiments/common/file.hpp"
#include "lancet/experiments/common/hash.hpp"
#include "lancet/experiments/pipeline/pace.hpp"
#include "lancet/experiments/pipeline/pictures.hpp"
#include "lancet/experiments/pipeline/world.hpp"

namespace lancet::experiments::pipeline {

namespace {

/// Steps as many as there is simulated time for, by the clock where the settings say so.
void step_through(runtime::Simulation& simulation, const PipelineSettings& settings, double start, Interactive& run,
                  Progress& progress) {
    const auto steps = static_cast<std::int64_t>(std::llround(settings.seconds / settings.time_step));
    const auto report_every = std::max<std::int64_t>(1, static_cast<std::int64_t>(2 / settings.time_step));
    run.step_seconds.reserve(static_cast<std::size_t>(steps));
    for (std::int64_t step = 0; step < steps; ++step) {
        const double due = start + static_cast<double>(step) * settings.time_step;
        if (settings.is_paced) sleep_until(due);
        const double begin = runtime::steady_seconds();
        simulation.step();
        const double end = runtime::steady_seconds();
        run.step_seconds.push_back(end - begin);
        if (settings.is_paced && end > due + settings.time_step) ++run.late_steps;
        if (step % report_every == 0) {
            progress.show(settings.scene + ": " + std::to_string(static_cast<int>(simulation.time())) + " of " +
                          std::to_string(static_cast<int>(settings.seconds)) + " s");
        }
    }
    run.steps = steps;
    run.seconds = runtime::steady_seconds() - start;
}

}  // namespace

Interactive run_interactive(const PipelineSettings& settings, Progress& progress) {
    const auto scheduler = runtime::make_scheduler(settings.scheduler, settings.threads);
    World world = make_world(settings, *scheduler);
    runtime::Simulation& simulation = *world.simulation;
    runtime::ToolPath path = settings.path.empty()
                                 ? built_in_path(world, settings)
                                 : runtime::resampled(runtime::read_tool_path(settings.path), 1 / settings.force_rate);
    std::erase_if(path, [&](const runtime::ToolSample& sample) { return sample.time > settings.seconds; });

    Interactive run;
    run.elements = world.elements;
    const auto steps = static_cast<std::size_t>(settings.seconds / settings.time_step) + 1;
    std::optional<runtime::Trace> trace;
    if (!settings.trace.empty()) trace.emplace(std::min<std::size_t>(32 * steps, 4'000'000));
    TaskTimes times(steps, trace ? &*trace : nullptr);
    simulation.observe_tasks(&times);

    Pictures pictures(world, settings.width, settings.height, settings.frames);
    simulation.observe_frames([&](const runtime::Frame& frame) {
        const double begin = runtime::steady_seconds();
        pictures.take(frame);
        const double end = runtime::steady_seconds();
        if (trace) trace->ended(-1, "picture", begin, end);
        run.picture_seconds.push_back(end - begin);
        if (frame.input_stamp > 0) run.frame_latency.push_back(end - frame.input_stamp);
    });
    if (!settings.dot.empty()) write_file(settings.dot, simulation.graph().to_dot());

    if (settings.is_paced) {
        const double start = runtime::steady_seconds() + 0.02;
        Device device(simulation, world.tool, std::move(path), start);
        step_through(simulation, settings, start, run, progress);
        run.device = device.stop();
    } else {
        simulation.play(world.tool, std::move(path));
        step_through(simulation, settings, runtime::steady_seconds(), run, progress);
    }
    simulation.finish();
    progress.clear();

    run.tasks = times.tasks();
    std::erase_if(run.tasks, [](const TaskTimes::Task& task) { return task.seconds.empty(); });
    run.collisions = simulation.collisions();
    run.frames = simulation.frame_statistics();
    run.cuts = simulation.cut_statistics();
    run.lost_steps = simulation.body(world.body).lost_steps();
    std::vector<Point> positions(simulation.body(world.body).body().nodes());
    simulation.body(world.body).body().positions(positions);
    for (const Point& at : positions) {
        run.is_finite = run.is_finite && std::isfinite(at[0]) && std::isfinite(at[1]) && std::isfinite(at[2]);
    }
    Hash hash;
    hash.add(std::span<const Point>(positions));
    run.fingerprint = hash.text();
    if (!settings.record.empty()) runtime::write_tool_path(settings.record, simulation.recorded(world.tool));
    if (trace) {
        trace->write(settings.trace);
        run.events_lost = trace->lost();
    }
    return run;
}

}  // namespace lancet::experiments::pipeline
