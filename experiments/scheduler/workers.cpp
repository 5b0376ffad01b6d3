#include "lancet/experiments/scheduler/workers.hpp"

#include "lancet/experiments/common/process.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::scheduler {
namespace {

WorkerReport run_worker(int elements, const WorkerJob& job, const SchedulerSettings& settings,
                        const std::string& label) {
    const ProcessResult result = run_process(
        {.program = this_program(), .arguments = worker_arguments(elements, job.kind, job.threads, settings)});
    if (!result.succeeded()) throw Error(label + ": the worker ended with " + describe(result.end));
    return report_from_line(result.output);
}

}  // namespace

std::vector<Measured> measure_all(const SchedulerSettings& settings, Progress& progress) {
    std::vector<Measured> rows;
    for (const int elements : settings.elements) {
        std::vector<WorkerJob> jobs;
        for (const int threads : settings.threads) {
            for (const runtime::SchedulerKind kind : settings.kinds) {
                if (kind == runtime::SchedulerKind::serial && threads > 1) continue;
                jobs.push_back(job_for(elements, settings));
                jobs.back().kind = kind;
                jobs.back().threads = threads;
            }
        }
        std::vector<std::vector<WorkerReport>> reports(jobs.size());
        for (int repetition = 0; repetition < settings.repetitions; ++repetition) {
            for (std::size_t k = 0; k < jobs.size(); ++k) {
                const std::string label = std::to_string(elements) + " elements, " +
                                          std::string(to_string(jobs[k].kind)) +
                                          ", threads: " + std::to_string(jobs[k].threads);
                progress.show(static_cast<std::size_t>(repetition) * jobs.size() + k + 1,
                              static_cast<std::size_t>(settings.repetitions) * jobs.size(), label);
                reports[k].push_back(run_worker(elements, jobs[k], settings, label));
            }
        }
        for (std::size_t k = 0; k < jobs.size(); ++k) {
            const auto found = evaluate(jobs[k], reports[k], reports.front().front().motion);
            rows.insert(rows.end(), found.begin(), found.end());
        }
    }
    return rows;
}

}  // namespace lancet::experiments::scheduler
