#include "lancet/experiments/stability/workers.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <mutex>
#include <optional>
#include <ostream>
#include <sstream>
#include <thread>

#include "lancet/experiments/common/process.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::stability {

namespace {

/// Hands out runs of cases, and takes what comes of them.
class Queue {
  public:
    Queue(const std::vector<Case>& cases, const WorkerSettings& settings, Progress& progress)
        : cases_(&cases), settings_(&settings), progress_(&progress), outcomes_(cases.size()) {}

    /// Works until nothing is left.
    void drain() {
        while (true) {
            std::size_t begin = 0, end = 0;
            {
                const std::lock_guard lock(mutex_);
                if (next_ == cases_->size() || error_ || settings_->stop.stop_requested()) return;
                begin = next_;
                end = next_ = std::min(begin + static_cast<std::size_t>(settings_->cases), cases_->size());
            }
            try {
                while (begin < end && !settings_->stop.stop_requested()) begin = run_some(begin, end);
                tell();
            } catch (...) {
                const std::lock_guard lock(mutex_);
                if (!error_) error_ = std::current_exception();
            }
        }
    }

    std::vector<Outcome> take() {
        if (error_) std::rethrow_exception(error_);
        return finished();
    }

  private:
    /// Runs one process, which may end before it has done all. Returns the first case that is left.
    std::size_t run_some(std::size_t begin, std::size_t end) {
        Command command{.program = settings_->program, .arguments = settings_->arguments};
        command.arguments.push_back("--worker=" + std::to_string(begin) + "," + std::to_string(end));
        if (!settings_->instruction_set.empty()) command.environment = {{"LANCET_ISA", settings_->instruction_set}};
        command.timeout = std::chrono::milliseconds(static_cast<std::int64_t>(1000 * settings_->seconds));
        command.stop = settings_->stop;
        const ProcessResult result = run_process(command);
        if (const auto* exited = std::get_if<Exited>(&result.end); exited != nullptr && exited->code == 2) {
            throw Error("stability: a worker refused its input");
        }
        std::istringstream lines(result.output);
        std::string line;
        while (begin < end && std::getline(lines, line) && !lines.eof()) {  // a last line without an end is cut short
            put(begin, verdict_of(nlohmann::ordered_json::parse(line)));
            ++begin;
        }
        if (begin < end && !std::holds_alternative<Stopped>(result.end)) {
            Verdict verdict;
            verdict.fail("the program ended here: " + describe(result.end));
            put(begin, verdict);
            ++begin;
        }
        return begin;
    }

    std::vector<Outcome> finished() const {
        std::vector<Outcome> finished;
        for (const std::optional<Outcome>& outcome : outcomes_) {
            if (outcome) finished.push_back(*outcome);
        }
        return finished;
    }

    /// Hands over what there is, if it is time.
    void tell() {
        const std::lock_guard lock(mutex_);
        const auto now = std::chrono::steady_clock::now();
        if (!settings_->interim || now - told_ < settings_->between_interims) return;
        settings_->interim(finished());
        told_ = std::chrono::steady_clock::now();
    }

    void put(std::size_t index, const Verdict& verdict) {
        const std::lock_guard lock(mutex_);
        outcomes_[index] = Outcome{(*cases_)[index], verdict};
        failed_ += verdict.survived ? 0 : 1;
        ++done_;
        if (done_ % 20 == 0 || done_ == cases_->size()) {
            progress_->show(done_, cases_->size(),
                            std::to_string(failed_) + " failed; " + categories()[(*cases_)[index].category].name);
        }
    }

    const std::vector<Case>* cases_;
    const WorkerSettings* settings_;
    Progress* progress_;
    std::mutex mutex_;
    std::vector<std::optional<Outcome>> outcomes_;
    std::chrono::steady_clock::time_point told_ = std::chrono::steady_clock::now();
    std::size_t next_ = 0, done_ = 0, failed_ = 0;
    std::exception_ptr error_;
};

}  // namespace

std::vector<Outcome> run_cases(const std::vector<Case>& cases, const WorkerSettings& settings, Progress& progress) {
    Queue queue(cases, settings, progress);
    {
        std::vector<std::jthread> threads;
        for (int k = 0; k < settings.processes; ++k) threads.emplace_back([&queue] { queue.drain(); });
    }
    return queue.take();
}

void work(const std::vector<Case>& cases, std::size_t begin, std::size_t end, runtime::Scheduler& scheduler,
          std::ostream& stream) {
    for (std::size_t k = begin; k < end; ++k) {
        stream << verdict_json(run_case(cases[k], scheduler)).dump() << '\n' << std::flush;
    }
}

}  // namespace lancet::experiments::stability
