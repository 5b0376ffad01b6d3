#include "lancet/experiments/pipeline/task_times.hpp"

namespace lancet::experiments::pipeline {

TaskTimes::TaskTimes(std::size_t capacity, runtime::Trace* trace)
    : capacity_(capacity), trace_(trace), tasks_(most_tasks) {}

void TaskTimes::ended(int task, std::string_view name, double begin, double end) noexcept {
    if (trace_ != nullptr) trace_->ended(task, name, begin, end);
    // A task runs on one thread at a time: nobody else writes to its times.
    if (task < 0 || static_cast<std::size_t>(task) >= tasks_.size()) return;
    Task& times = tasks_[static_cast<std::size_t>(task)];
    if (times.name.empty()) {
        times.name = name;
        times.seconds.reserve(capacity_);
    }
    if (times.seconds.size() < capacity_) times.seconds.push_back(end - begin);
}

}  // namespace lancet::experiments::pipeline
