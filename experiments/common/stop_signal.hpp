#pragma once

#include <csignal>
#include <stop_token>
#include <thread>

namespace lancet::experiments {

/// As long as it lives, SIGINT and SIGTERM do not end the program, but ask whoever has the token to stop. Threads and
/// programs that are started meanwhile do not see the signals. Make it before any thread.
class StopOnSignal {
  public:
    StopOnSignal();
    StopOnSignal(const StopOnSignal&) = delete;
    StopOnSignal& operator=(const StopOnSignal&) = delete;
    ~StopOnSignal();

    [[nodiscard]] std::stop_token token() const noexcept { return stop_.get_token(); }

  private:
    sigset_t before_{};
    std::stop_source stop_;
    std::jthread watch_;
};

}  // namespace lancet::experiments
