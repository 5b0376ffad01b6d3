#include "lancet/experiments/scaling/measure.hpp"

#include <cmath>
#include <map>
#include <system_error>
#include <tuple>

#include "lancet/experiments/bar/reference.hpp"
#include "lancet/experiments/common/process.hpp"
#include "lancet/experiments/scaling/problem.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::scaling {
namespace {

Report run_worker(const std::filesystem::path& program, std::vector<std::string> arguments, const std::string& label) {
    const ProcessResult result = run_process(
        {.program = program, .arguments = std::move(arguments), .environment = {}, .timeout = std::nullopt});
    if (!result.succeeded()) {
        throw Error(label + ": the worker ended with " + describe(result.end) + ", expected exit code 0");
    }
    return report_from_line(result.output, label);
}

/// The converged solutions that the jobs are compared with, by benchmark and elements asked for.
class Solutions {
  public:
    Solutions(const ScalingSettings& settings, std::filesystem::path program)
        : settings_(&settings), program_(std::move(program)) {}

    /// The file of the solution for a job; empty where its run does not get to error_time.
    std::filesystem::path file_for(const Job& job, Progress& progress) {
        const auto key = std::tuple(job.benchmark, job.elements);
        const Benchmark benchmark = make_benchmark(job.benchmark, job.elements, job.steps);
        const auto steps = static_cast<int>(std::round(error_time / benchmark.problem.time_step));
        if (settings_->no_errors || steps > job.steps) return {};
        const auto known = files_.find(key);
        if (known != files_.end()) return known->second;
        const std::filesystem::path file = settings_->cache / ("state-" + solution_key(benchmark));
        files_[key] = file;
        if (std::filesystem::exists(file)) return file;

        std::error_code failed;
        std::filesystem::create_directories(settings_->cache, failed);
        if (failed) throw Error(settings_->cache.string() + ": cannot be made: " + failed.message());
        progress.show("computing the converged solution of " + job.benchmark + ", " + std::to_string(job.elements) +
                      " elements, kept in " + file.string());
        std::vector<std::string> arguments = bar::converged_arguments();
        arguments.insert(arguments.end(),
                         {"--problem=" + job.benchmark, "--elements=" + std::to_string(job.elements),
                          "--steps=" + std::to_string(steps), "--snapshots=" + file.string(), "--snapshot-times=1"});
        (void)run_worker(program_, std::move(arguments), "converged solution of " + job.benchmark);
        return file;
    }

  private:
    const ScalingSettings* settings_;
    std::filesystem::path program_;
    std::map<std::tuple<std::string, int>, std::filesystem::path> files_;
};

}  // namespace

Measurement measure(const Plan& plan, const ScalingSettings& settings, const std::filesystem::path& folder,
                    Progress& progress) {
    const std::filesystem::path program = folder / "scaling_worker";
    Solutions solutions(settings, program);
    std::vector<std::vector<std::string>> commands;
    for (const Job& job : plan.jobs) {
        std::vector<std::string> arguments = worker_arguments(job);
        const std::filesystem::path reference = solutions.file_for(job, progress);
        if (!reference.empty()) arguments.push_back("--reference=" + reference.string());
        if (settings.pin) arguments.emplace_back("--pin");
        arguments.emplace_back("--limits");
        commands.push_back(std::move(arguments));
    }
    Measurement measurement(plan.jobs.size());
    const auto run_job = [&](std::size_t job) {
        measurement[job].push_back(run_worker(program, commands[job], plan.jobs[job].label()));
    };
    const auto repetitions = static_cast<std::size_t>(settings.repetitions);
    for (std::size_t repetition = 0; repetition < repetitions; ++repetition) {
        for (std::size_t job = 0; job < plan.jobs.size(); ++job) {
            progress.show(repetition * plan.jobs.size() + job + 1, repetitions * plan.jobs.size(),
                          plan.jobs[job].label());
            run_job(job);
        }
    }
    for (int round = 0; round < settings.extra_rounds; ++round) {
        for (std::size_t job = 0; job < plan.jobs.size(); ++job) {
            const auto lost = lost_shares(measurement[job], shortest_spin(measurement));
            if (judge(lost, enough_quiet(settings.repetitions)) == LoadMark::quiet) continue;
            progress.show("disturbed, once more: " + plan.jobs[job].label());
            run_job(job);
        }
    }
    return measurement;
}

double shortest_spin(const Measurement& measurement) {
    double shortest = 0;
    for (const auto& reports : measurement) {
        for (const Report& report : reports) {
            const double spin = report.load.spin_seconds;
            if (spin > 0 && (shortest == 0 || spin < shortest)) shortest = spin;
        }
    }
    return shortest;
}

bool is_oversubscribed(const Report& report) {
    return report.run.threads > report.cores;
}

std::vector<double> lost_shares(std::span<const Report> reports, double shortest_spin) {
    std::vector<double> lost;
    for (const Report& report : reports) {
        lost.push_back(lost_share(report.load, shortest_spin, is_oversubscribed(report), report.cores));
    }
    return lost;
}

}  // namespace lancet::experiments::scaling
