#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <thread>

#include "lancet/runtime/simulate/frame.hpp"

namespace lancet::runtime {

/// A thread of its own for what takes long with frames, files and pictures. It has room for one frame: who comes while
/// it is busy does not wait.
class FrameThread {
  public:
    explicit FrameThread(std::function<void(const Frame&)> observer);
    FrameThread(const FrameThread&) = delete;
    FrameThread& operator=(const FrameThread&) = delete;
    /// Ends when the frame that was submitted last has been observed.
    ~FrameThread();

    /// Room for the next frame, with what was in it before; nullptr while the last one is being observed.
    Frame* begin() noexcept;
    /// Hands over the frame that was begun.
    void submit() noexcept;
    /// Returns when there is room.
    void wait() noexcept;
    /// Throws what the observer has thrown, once. Call when there is room.
    void rethrow();

    std::int64_t observed() const noexcept { return observed_.load(std::memory_order_relaxed); }

  private:
    enum class State { free, full, stopping };

    void work();

    std::function<void(const Frame&)> observer_;
    Frame frame_;
    std::exception_ptr exception_;  ///< written while full, read while free
    std::atomic<std::int64_t> observed_{0};
    std::atomic<State> state_{State::free};
    std::thread thread_;
};

}  // namespace lancet::runtime
