#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "lancet/runtime/schedule/function_reference.hpp"
#include "lancet/runtime/schedule/loop.hpp"

namespace lancet::runtime {

/// Helpers that stay from loop to loop. A solver runs tens of loops of some tens of microseconds in a row: to call a
/// thread of a task scheduler to each costs microseconds, and milliseconds where it has gone to sleep. Here a thread
/// that was called once looks for further loops for a while, and leaves where none comes or a task waits for a thread.
/// Nobody waits for helpers that do not come: chunks that none has begun are run by the thread whose loop it is.
class LoopCrew {
  public:
    /// For loops of up to `threads` chunks: one of the thread that calls, the others of helpers.
    explicit LoopCrew(int threads);

    /// The sole use of the crew, if it was free.
    class Lease {
      public:
        explicit Lease(LoopCrew& crew) noexcept
            : crew_(crew), is_granted_(!crew.is_taken_.exchange(true, std::memory_order_acquire)) {}
        Lease(const Lease&) = delete;
        Lease& operator=(const Lease&) = delete;
        ~Lease() {
            if (is_granted_) crew_.is_taken_.store(false, std::memory_order_release);
        }
        bool is_granted() const noexcept { return is_granted_; }

      private:
        LoopCrew& crew_;
        bool is_granted_;
    };

    /// Runs a loop; needs a lease. `call` is called for each helper that is missing, and has a thread call `serve` some
    /// time, if it can.
    void run(ChunkedLoop& loop, FunctionReference<void()> call);

    /// What a helper does. Returns at once on the thread that ran the last loop.
    void serve() noexcept;

    /// A task is ready to run (1), or begins (-1): while some are ready for more than a moment, helpers leave.
    void count_ready(int change) noexcept { ready_.fetch_add(change, std::memory_order_relaxed); }

    /// The calling thread waits for tasks, and may be made a helper while it does: until they have ended (send_home).
    void expect_home() noexcept;
    /// The thread that called expect_home leaves, if it is a helper. Others stay: the next tasks may come soon, and a
    /// thread that has gone to sleep takes a hundred microseconds to come back.
    void send_home() noexcept { expected_.store(nullptr, std::memory_order_relaxed); }

    /// Helpers leave, and nobody stays from now on. Those that were called and have not served yet must still do so.
    void dismiss() noexcept { is_dismissed_.store(true, std::memory_order_relaxed); }

  private:
    struct alignas(64) Chunk {
        std::atomic<std::uint64_t> round{0};  ///< in which it was begun last
    };

    bool begin(int chunk, std::uint64_t round) noexcept;
    /// Runs chunks that nobody has begun, first the one with the number `first`; returns how many.
    int run_chunks(int first, std::uint64_t round) noexcept;
    bool await_round(std::uint64_t seen, bool is_expected) const noexcept;

    alignas(64) std::atomic<std::uint64_t> round_{0};  ///< raised to start a loop; apart from what others write
    alignas(64) std::atomic<int> helped_{0};           ///< chunks that helpers have ended
    alignas(64) int threads_;
    std::atomic<bool> is_taken_{false}, is_dismissed_{false};
    std::atomic<int> ready_{0};
    std::atomic<const void*> expected_{nullptr};  ///< a mark of the thread that waits for tasks
    std::atomic<const void*> runner_{nullptr};    ///< a mark of the thread that ran the last loop
    std::atomic<int> helpers_{0};                 ///< called, and not gone
    std::vector<std::atomic<bool>> seats_;        ///< a helper keeps to one chunk, whose data its core has
    std::vector<Chunk> chunks_;
    ChunkedLoop* loop_ = nullptr;  ///< published by round_
};

}  // namespace lancet::runtime
