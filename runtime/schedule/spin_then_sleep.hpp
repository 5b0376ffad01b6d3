#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>

#include "lancet/runtime/schedule/pause.hpp"

namespace lancet::runtime {

/// Lets threads wait for a condition over atomics that another thread makes true: they look at it for a short while
/// and then sleep. Whoever may have made it true calls notify().
class SpinThenSleep {
  public:
    /// `looks`: how often to look before sleeping, with a pause of some 10 ns between; 0 sleeps at once.
    explicit SpinThenSleep(int looks) : looks_(looks) {}

    template <class Condition>
    void wait(Condition condition) {
        for (int look = 0; look < looks_; ++look) {
            if (condition()) return;
            pause_thread();
        }
        std::unique_lock lock(mutex_);
        sleepers_.fetch_add(1, std::memory_order_acq_rel);
        sleep_.wait(lock, condition);
        sleepers_.fetch_sub(1, std::memory_order_acq_rel);
    }

    void notify() {
        // Reading by read-modify-write puts this before or after the sleeper's increment: before, and it sees the
        // condition; after, and it is woken.
        if (sleepers_.fetch_add(0, std::memory_order_acq_rel) == 0) return;
        const std::scoped_lock lock(mutex_);
        sleep_.notify_all();
    }

  private:
    int looks_;
    std::atomic<int> sleepers_{0};
    std::mutex mutex_;
    std::condition_variable sleep_;
};

}  // namespace lancet::runtime
