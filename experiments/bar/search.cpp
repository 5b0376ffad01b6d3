#include "lancet/experiments/bar/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "lancet/experiments/bar/errors.hpp"
#include "lancet/experiments/bar/workers.hpp"
#include "lancet/experiments/common/table.hpp"

namespace lancet::experiments::bar {
namespace {

/// One run to t = 1 s.
struct Trial {
    Job job;
    double error = std::numeric_limits<double>::infinity();
};

bool reaches(const Trial& trial) {
    return trial.error <= accurate_error_percent;
}

double fastest(const JobResult& result) {
    double seconds = std::numeric_limits<double>::infinity();
    for (const WorkerReport& report : result.reports) seconds = std::min(seconds, report.seconds_total);
    return seconds;
}

/// The problem to t = 1 s.
ProblemOptions for_a_second(const ProblemOptions& options) {
    ProblemOptions one_second = options;
    one_second.steps = std::max(1, static_cast<int>(std::round(1 / options.time_step)));
    return one_second;
}

}  // namespace

Job fastest_of(const std::vector<Job>& jobs, const ProblemOptions& options, const Problem& problem,
               Progress& progress) {
    constexpr int timings = 3;
    const bool is_one =
        std::all_of(jobs.begin(), jobs.end(), [&](const Job& job) { return job.arguments == jobs.front().arguments; });
    if (is_one) return jobs.front();
    const std::vector<JobResult> results =
        run_jobs(jobs, timings, for_a_second(options), {}, problem.mesh.nodes().size(), progress);
    const auto best = std::min_element(results.begin(), results.end(),
                                       [](const JobResult& a, const JobResult& b) { return fastest(a) < fastest(b); });
    return jobs[static_cast<std::size_t>(best - results.begin())];
}

Job search(const Entry& entry, const Choice& choice, std::size_t variation, const ProblemOptions& options,
           const Problem& problem, const std::vector<double>& reference, const std::filesystem::path& folder,
           Progress& progress) {
    const std::size_t nodes = problem.mesh.nodes().size();
    const ProblemOptions one_second = for_a_second(options);
    const auto attempt = [&](const std::vector<std::string>& arguments) {
        Trial trial{jobs_of(entry, arguments, choice, folder)[variation]};
        progress.show("looking for " + format_number(accurate_error_percent, 3) + " %: " + trial.job.label());
        std::vector<std::vector<double>> snapshots;
        run_worker(trial.job, one_second, {1.0}, nodes, snapshots);
        const double error = error_percent(problem, snapshots.front(), reference);
        if (std::isfinite(error)) trial.error = error;
        return trial;
    };

    std::vector<Job> ends;
    std::optional<Trial> least_wrong;
    for (const auto& sequence : entry.sequences) {
        std::optional<Trial> end;
        std::size_t end_at = sequence.size();
        for (std::size_t first = 0, last = sequence.size(); first < last;) {
            const std::size_t middle = first + (last - first) / 2;
            const Trial trial = attempt(sequence[middle]);
            if (!least_wrong || trial.error < least_wrong->error) least_wrong = trial;
            if (reaches(trial)) {
                end = trial;
                end_at = last = middle;
            } else {
                first = middle + 1;
            }
        }
        // Errors fall with the effort, but not at every step: one or two settings below the first may do as well.
        for (std::size_t below = 1; end && below <= 2 && below <= end_at; ++below) {
            const Trial trial = attempt(sequence[end_at - below]);
            if (reaches(trial)) end = trial;
        }
        if (end) ends.push_back(end->job);
    }
    if (ends.empty()) return least_wrong->job;
    return fastest_of(ends, options, problem, progress);
}

}  // namespace lancet::experiments::bar
