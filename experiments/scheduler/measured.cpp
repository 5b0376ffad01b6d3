#include "lancet/experiments/scheduler/measured.hpp"

#include <algorithm>
#include <functional>

#include "lancet/experiments/common/statistics.hpp"

namespace lancet::experiments::scheduler {
namespace {

/// The median over steps of f(step) for each repetition.
template <class F>
Spread over_repetitions(std::span<const WorkerReport> reports, std::size_t subject, const F& of_step) {
    std::vector<double> medians;
    for (const WorkerReport& report : reports) {
        std::vector<double> values;
        for (std::size_t step = 0; step < report.subjects[subject].seconds.size(); ++step) {
            values.push_back(of_step(report, step));
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
        const auto ratio_to = [k](std::size_t other) {
            return [k, other](const WorkerReport& report, std::size_t step) {
                return report.subjects[k].seconds[step] / report.subjects[other].seconds[step];
            };
        };
        row.to_serial = over_repetitions(reports, k, ratio_to(0));
        row.to_bare = over_repetitions(reports, k, ratio_to(bare));
        if (row.extras != Extras::nothing) {
            row.frames = over_repetitions(reports, k, [&](const WorkerReport& report, std::size_t step) {
                return report.subjects[k].frame_seconds[step];
            });
            row.side = over_repetitions(reports, k, [&](const WorkerReport& report, std::size_t step) {
                return report.subjects[k].side_seconds[step] / report.subjects[bare].seconds[step];
            });
            row.graph = over_repetitions(reports, k, [&](const WorkerReport& report, std::size_t step) {
                const SubjectReport& of = report.subjects[k];
                return (of.seconds[step] - of.task_seconds[step]) / report.subjects[bare].seconds[step];
            });
        }
        if (row.extras == Extras::frames) {
            row.hidden = over_repetitions(reports, k, [&](const WorkerReport& report, std::size_t step) {
                const SubjectReport& of = report.subjects[k];
                const double longer = of.seconds[step] - report.subjects[without_frames].seconds[step];
                return 1 - longer / of.frame_seconds[step];
            });
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace lancet::experiments::scheduler
