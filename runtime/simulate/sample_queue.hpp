#pragma once

#include <array>
#include <atomic>
#include <cstddef>

#include "lancet/runtime/simulate/tool.hpp"

namespace lancet::runtime {

/// Samples of a tool on their way from the thread of the device to that of the simulation; neither waits.
class SampleQueue {
  public:
    /// From one thread; false if the queue is full: the sample is not taken.
    bool push(const ToolSample& sample) noexcept {
        const std::size_t end = end_.load(std::memory_order_relaxed);
        if (end - begin_.load(std::memory_order_acquire) == capacity) return false;
        samples_[end % capacity] = sample;
        end_.store(end + 1, std::memory_order_release);
        return true;
    }

    /// From one thread; false if there is none.
    bool pop(ToolSample& sample) noexcept {
        const std::size_t begin = begin_.load(std::memory_order_relaxed);
        if (begin == end_.load(std::memory_order_acquire)) return false;
        sample = samples_[begin % capacity];
        begin_.store(begin + 1, std::memory_order_release);
        return true;
    }

  private:
    static constexpr std::size_t capacity = 1024;  ///< a second of a haptic device

    std::array<ToolSample, capacity> samples_;
    alignas(64) std::atomic<std::size_t> begin_{0};
    alignas(64) std::atomic<std::size_t> end_{0};
};

}  // namespace lancet::runtime
