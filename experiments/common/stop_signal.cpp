#include "lancet/experiments/common/stop_signal.hpp"

#include <ctime>

namespace lancet::experiments {

StopOnSignal::StopOnSignal() {
    sigset_t signals{};
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    // Blocked signals wait until they are asked for: nothing has to run inside of a handler.
    pthread_sigmask(SIG_BLOCK, &signals, &before_);
    watch_ = std::jthread([signals, stop = stop_](const std::stop_token& end) mutable {
        constexpr timespec pause{.tv_sec = 0, .tv_nsec = 50'000'000};
        while (!end.stop_requested()) {
            if (sigtimedwait(&signals, nullptr, &pause) > 0) stop.request_stop();
        }
    });
}

StopOnSignal::~StopOnSignal() {
    watch_.request_stop();
    watch_.join();
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

}  // namespace lancet::experiments
