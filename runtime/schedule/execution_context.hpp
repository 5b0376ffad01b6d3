#pragma once

#include <utility>

namespace lancet::runtime {

/// What the calling thread is doing for its schedulers; a scheduler that is called from a body or a task asks for it.
struct ExecutionContext {
    const void* loop = nullptr;   ///< the scheduler whose block the thread is running, or null
    const void* graph = nullptr;  ///< the scheduler whose graph task the thread is running, or null

    /// The context of the calling thread.
    static ExecutionContext& current() noexcept {
        static thread_local ExecutionContext context;
        return context;
    }
};

/// While it lives, the calling thread is known to run a block of the loop of a scheduler.
class LoopScope {
  public:
    explicit LoopScope(const void* scheduler) noexcept
        : outer_(std::exchange(ExecutionContext::current().loop, scheduler)) {}
    LoopScope(const LoopScope&) = delete;
    LoopScope& operator=(const LoopScope&) = delete;
    ~LoopScope() { ExecutionContext::current().loop = outer_; }

  private:
    const void* outer_;
};

/// While it lives, the calling thread is known to run a task of a graph of a scheduler.
class GraphScope {
  public:
    explicit GraphScope(const void* scheduler) noexcept
        : outer_(std::exchange(ExecutionContext::current(), ExecutionContext{nullptr, scheduler})) {}
    GraphScope(const GraphScope&) = delete;
    GraphScope& operator=(const GraphScope&) = delete;
    ~GraphScope() { ExecutionContext::current() = outer_; }

  private:
    ExecutionContext outer_;
};

}  // namespace lancet::runtime
