#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "lancet/experiments/common/statistics.hpp"
#include "lancet/experiments/pipeline/interactive.hpp"

namespace lancet::experiments::pipeline {

namespace {

Cell quantile_ms(std::span<const double> seconds, double fraction) {
    if (seconds.empty()) return {};
    return 1e3 * quantile(seconds, fraction);
}

std::vector<double> seconds_of(const Interactive& run, const std::string& ending) {
    std::vector<double> all;
    for (const TaskTimes::Task& task : run.tasks) {
        if (task.name.ends_with(ending)) all.insert(all.end(), task.seconds.begin(), task.seconds.end());
    }
    return all;
}

}  // namespace

Table rate_table(const Interactive& run, const PipelineSettings& settings) {
    Table table({{"task", "task"},
                 {"rate_asked", "rate asked", "Hz"},
                 {"rate_held", "rate held", "Hz"},
                 {"due", "due"},
                 {"missed", "missed"},
                 {"p50_ms", "p50", "ms"},
                 {"p95_ms", "p95", "ms"},
                 {"p999_ms", "p99.9", "ms"},
                 {"latency_p50_ms", "latency p50", "ms"},
                 {"latency_p95_ms", "p95", "ms"},
                 {"latency_p999_ms", "p99.9", "ms"}});
    const auto add = [&](const std::string& task, double asked, double held, std::int64_t due, Cell missed,
                         std::span<const double> seconds, std::span<const double> latency) {
        table.add_row({task, asked, held, due, std::move(missed), quantile_ms(seconds, 0.5), quantile_ms(seconds, 0.95),
                       quantile_ms(seconds, 0.999), quantile_ms(latency, 0.5), quantile_ms(latency, 0.95),
                       quantile_ms(latency, 0.999)});
    };
    const auto missed = [&](std::int64_t count) { return settings.is_paced ? Cell(count) : Cell(); };
    const auto steps = static_cast<double>(run.steps);
    add("step", 1 / settings.time_step, steps / run.seconds, run.steps, missed(run.late_steps), run.step_seconds, {});
    add("collision", settings.collision_rate, static_cast<double>(run.collisions) / run.seconds,
        std::llround(settings.seconds * settings.collision_rate),
        Cell(std::max<std::int64_t>(0, std::llround(settings.seconds * settings.collision_rate) - run.collisions)),
        seconds_of(run, "tool collision"), {});
    add("frame", settings.frame_rate, static_cast<double>(run.frames.observed) / run.seconds, run.frames.due,
        run.frames.dropped, run.picture_seconds, run.frame_latency);
    if (settings.is_paced) {
        add("force", settings.force_rate, static_cast<double>(run.device.due) / std::max(run.device.seconds, 1e-9),
            run.device.due, run.device.missed, run.device.force_seconds, run.device.latency);
    }
    return table;
}

Table task_table(const Interactive& run) {
    Table table({{"task", "task"},
                 {"runs", "runs"},
                 {"mean_us", "mean", "us"},
                 {"p50_us", "p50", "us"},
                 {"p95_us", "p95", "us"},
                 {"p999_us", "p99.9", "us"},
                 {"percent", "of all tasks", "%"}});
    const auto sum = [](const std::vector<double>& values) {
        return std::accumulate(values.begin(), values.end(), 0.0);
    };
    double all = 0;
    for (const TaskTimes::Task& task : run.tasks) all += sum(task.seconds);
    for (const TaskTimes::Task& task : run.tasks) {
        const double total = sum(task.seconds);
        table.add_row({task.name, static_cast<std::int64_t>(task.seconds.size()),
                       1e6 * total / static_cast<double>(task.seconds.size()), 1e6 * quantile(task.seconds, 0.5),
                       1e6 * quantile(task.seconds, 0.95), 1e6 * quantile(task.seconds, 0.999), 100 * total / all});
    }
    return table;
}

}  // namespace lancet::experiments::pipeline
