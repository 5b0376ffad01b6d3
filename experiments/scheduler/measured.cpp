#include "lancet/experiments/scheduler/measured.hpp"

#include <algorithm>
#include <numeric>

#include "lancet/experiments/common/statistics.hpp"

namespace lancet::experiments::scheduler {
namespace {

/// Some steps in a row of each subject in one process.
struct Window {
    const WorkerReport* report;
    std::size_t begin, end;

    double sum(const std::vector<double>& of_steps) const {
        const auto first = of_steps.begin();
        return std::accumulate(first + static_cast<std::ptrdiff_t>(begin), first + static_cast<std::ptrdiff_t>(end),
                               0.0);
    }
    const SubjectReport& subject(std::size_t k) const { return report->subjects[k]; }
    double seconds(std::size_t k) const { return sum(subject(k).seconds); }
};

/// The median over windows of value(window), for each repetition.
template <class Value>
Spread over_repetitions(std::span<const WorkerReport> reports, int window, const Value& value) {
    std::vector<double> medians;
    for (const WorkerReport& report : reports) {
        const std::size_t steps = report.subjects.front().seconds.size(), length = static_cast<std::size_t>(window);
        std::vector<double> values;
        for (std::size_t begin = 0; begin + length <= steps; begin += length) {
            values.push_back(value(Window{&report, begin, begin + length}));
        }
        medians.push_back(median(values));
    }
    return spread(medians);
}

}  // namespace

Spread spread(std::span<const double> values) {
    const Summary summary = summarize(values);
    return {summary.minimum, summary.median, summary.maximum};
}

std::string form_name(runtime::SchedulerKind kind, bool is_tasks) {
    switch (kind) {
        case runtime::SchedulerKind::tbb:
            return is_tasks ? "graph" : "loops";
        case runtime::SchedulerKind::openmp:
            return is_tasks ? "openmp-tasks" : "openmp-loops";
        default:
            return is_tasks ? "serial-tasks" : "serial";
    }
}

std::vector<Measured> evaluate(const WorkerJob& job, std::span<const WorkerReport> reports, const std::string& motion) {
    const bool is_serial = job.kind == runtime::SchedulerKind::serial;
    const std::size_t first = is_serial ? 0 : 1;
    // One thread: what a graph costs is measured against the step without any scheduler.
    const std::size_t bare = job.threads == 1 ? 0 : 1;
    const auto& subjects = reports.front().subjects;
    std::size_t without_frames = 0;
    for (std::size_t k = 0; k < subjects.size(); ++k) {
        if (subjects[k].is_tasks && subjects[k].extras == to_string(Extras::nothing)) without_frames = k;
    }

    std::vector<Measured> rows;
    for (std::size_t k = first; k < subjects.size(); ++k) {
        Measured row{.elements = job.problem.elements(), .threads = job.threads};
        row.form = form_name(job.kind, subjects[k].is_tasks);
        row.extras = extras_from_string(subjects[k].extras);
        row.tasks = subjects[k].tasks;
        row.bit_identical = true;
        std::vector<double> empty;
        for (const WorkerReport& report : reports) {
            const SubjectReport& of = report.subjects[k];
            row.seconds.insert(row.seconds.end(), of.seconds.begin(), of.seconds.end());
            row.bit_identical = row.bit_identical && of.bit_identical && report.motion == motion;
            if (row.tasks > 0) empty.push_back(of.empty_graph_seconds / row.tasks);
        }
        if (!empty.empty()) row.seconds_per_task = median(empty);
        const auto over_windows = [&](const auto& value) { return over_repetitions(reports, job.window, value); };
        row.to_serial = over_windows([&](const Window& w) { return w.seconds(k) / w.seconds(0); });
        row.to_bare = over_windows([&](const Window& w) { return w.seconds(k) / w.seconds(bare); });
        if (row.extras != Extras::nothing) {
            row.frames = over_windows([&](const Window& w) {
                return w.sum(w.subject(k).frame_seconds) / static_cast<double>(w.end - w.begin);
            });
            row.side =
                over_windows([&](const Window& w) { return w.sum(w.subject(k).side_seconds) / w.seconds(bare); });
            row.graph = over_windows(
                [&](const Window& w) { return (w.seconds(k) - w.sum(w.subject(k).task_seconds)) / w.seconds(bare); });
        }
        if (row.extras == Extras::frames) {
            row.hidden = over_windows([&](const Window& w) {
                return 1 - (w.seconds(k) - w.seconds(without_frames)) / w.sum(w.subject(k).frame_seconds);
            });
            row.beside = over_windows([&](const Window& w) {
                return w.sum(w.subject(k).frame_seconds_beside) / w.sum(w.subject(k).frame_seconds);
            });
            row.hidden_at_most =
                over_windows([&](const Window& w) { return w.seconds(without_frames) / w.seconds(0); });
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace lancet::experiments::scheduler
