#include "lancet/experiments/bar/workers.hpp"

#include <cstdlib>
#include <system_error>

#include "lancet/experiments/common/process.hpp"
#include "lancet/experiments/common/table.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::bar {
namespace {

/// An empty folder for snapshots, removed with this object.
class ScratchFolder {
  public:
    ScratchFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "lancet-bar-XXXXXX").string();
        if (::mkdtemp(name.data()) == nullptr) throw Error("cannot make the folder '" + name + "' for snapshots");
        path_ = name;
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    ~ScratchFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

std::string join(const std::vector<double>& values) {
    std::string text;
    for (const double value : values) {
        text += (text.empty() ? "" : ",") + format_exact(value);
    }
    return text;
}

}  // namespace

WorkerReport run_worker(const Job& job, const ProblemOptions& problem, const std::vector<double>& snapshot_times,
                        std::size_t nodes, std::vector<std::vector<double>>& snapshots) {
    const ScratchFolder folder;
    const std::filesystem::path file = folder.path() / "snapshots";
    Command command;
    command.program = job.program;
    command.arguments = job.arguments;
    for (const std::string& argument : problem_arguments(problem)) command.arguments.push_back(argument);
    if (!snapshot_times.empty()) {
        command.arguments.push_back("--snapshots=" + file.string());
        command.arguments.push_back("--snapshot-times=" + join(snapshot_times));
    }
    const ProcessResult result = run_process(command);
    if (!result.succeeded()) {
        throw Error(job.label() + ": the worker ended with " + describe(result.end) + ", expected exit code 0");
    }
    WorkerReport report = report_from_line(result.output, job.label());
    if (!snapshot_times.empty()) snapshots = read_snapshots(file, snapshot_times.size(), nodes);
    return report;
}

std::vector<JobResult> run_jobs(const std::vector<Job>& jobs, int repetitions, const ProblemOptions& problem,
                                const std::vector<double>& snapshot_times, std::size_t nodes, Progress& progress) {
    std::vector<JobResult> results(jobs.size());
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        for (std::size_t i = 0; i < jobs.size(); ++i) {
            progress.show(static_cast<std::size_t>(repetition) * jobs.size() + i + 1,
                          static_cast<std::size_t>(repetitions) * jobs.size(), jobs[i].label());
            const std::vector<double> times = repetition == 0 ? snapshot_times : std::vector<double>{};
            results[i].reports.push_back(run_worker(jobs[i], problem, times, nodes, results[i].snapshots));
        }
    }
    return results;
}

}  // namespace lancet::experiments::bar
