#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "lancet/runtime/observe/trace.hpp"

namespace lancet::experiments::pipeline {

/// Keeps how long each run of each task took, and hands everything on to a trace where there is one.
class TaskTimes final : public runtime::TaskObserver {
  public:
    struct Task {
        std::string name;
        std::vector<double> seconds;
    };

    /// Room for so many runs of each task; further ones are not kept. `trace` may be nullptr.
    TaskTimes(std::size_t capacity, runtime::Trace* trace);

    void ended(int task, std::string_view name, double begin, double end) noexcept override;

    /// What was kept, by the first run of each. Call when nothing runs.
    [[nodiscard]] const std::vector<Task>& tasks() const noexcept { return tasks_; }

  private:
    static constexpr std::size_t most_tasks = 256;

    std::size_t capacity_;
    runtime::Trace* trace_;
    std::vector<Task> tasks_;
};

}  // namespace lancet::experiments::pipeline
