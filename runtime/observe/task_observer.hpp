#pragma once

#include <string_view>

namespace lancet::runtime {

/// Is told of every task of a simulation that has run. Called on the thread that ran it, of several threads at a time.
class TaskObserver {
  public:
    virtual ~TaskObserver() = default;

    /// `task` is a number that stays with its name; begin and end are of steady_seconds().
    virtual void ended(int task, std::string_view name, double begin, double end) noexcept = 0;
};

}  // namespace lancet::runtime
