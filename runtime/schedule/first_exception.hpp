#pragma once

#include <atomic>
#include <exception>
#include <limits>
#include <mutex>
#include <utility>

namespace lancet::runtime {

/// Of the exceptions that concurrent pieces of work throw, keeps the one whose position is smallest.
class FirstException {
  public:
    /// Call in a catch block: records the exception being handled, thrown by the work at `position`.
    void record(int position) noexcept {
        const std::scoped_lock lock(mutex_);
        if (position < position_.load(std::memory_order_relaxed)) {
            position_.store(position, std::memory_order_relaxed);
            exception_ = std::current_exception();
        }
    }

    /// True if work at a smaller position has thrown, so that the work at `position` need not start.
    bool precedes(int position) const noexcept { return position_.load(std::memory_order_relaxed) < position; }

    /// True if anything has thrown.
    bool any() const noexcept { return position_.load(std::memory_order_relaxed) != none; }

    /// Rethrows what was recorded, if anything, and forgets it. Call when all work has ended.
    void rethrow() {
        if (!any()) return;
        position_.store(none, std::memory_order_relaxed);
        std::rethrow_exception(std::exchange(exception_, nullptr));
    }

  private:
    static constexpr int none = std::numeric_limits<int>::max();

    std::mutex mutex_;
    std::atomic<int> position_{none};
    std::exception_ptr exception_;
};

}  // namespace lancet::runtime
