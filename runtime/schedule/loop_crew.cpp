#include "lancet/runtime/schedule/loop_crew.hpp"

#include <thread>

#include "lancet/runtime/schedule/pause.hpp"

namespace lancet::runtime {
namespace {

/// A pause takes some 10 to 40 ns.
constexpr int looks_for_a_round = 12000;  // some hundred microseconds
constexpr int looks_at_ready_tasks = 100;
constexpr int looks_before_yield = 2000;

/// An address that no two threads share.
const void* this_thread() noexcept {
    thread_local const char mark = 0;
    return &mark;
}

}  // namespace

LoopCrew::LoopCrew(int threads)
    : threads_(threads), seats_(static_cast<std::size_t>(threads)), chunks_(static_cast<std::size_t>(threads)) {}

bool LoopCrew::begin(int chunk, std::uint64_t round) noexcept {
    // One who comes late, with a round that is over, finds all chunks begun in this one or a later one.
    std::atomic<std::uint64_t>& last = chunks_[static_cast<std::size_t>(chunk)].round;
    std::uint64_t before = last.load(std::memory_order_relaxed);
    return before < round && last.compare_exchange_strong(before, round, std::memory_order_acq_rel);
}

int LoopCrew::run_chunks(int first, std::uint64_t round) noexcept {
    int count = 0;
    for (int k = 0; k < threads_; ++k) {
        const int chunk = (first + k) % threads_;
        if (!begin(chunk, round)) continue;
        loop_->run_chunk(chunk);
        ++count;
    }
    return count;
}

void LoopCrew::run(ChunkedLoop& loop, FunctionReference<void()> call) {
    const std::uint64_t round = round_.load(std::memory_order_relaxed) + 1;
    runner_.store(this_thread(), std::memory_order_relaxed);
    loop_ = &loop;
    helped_.store(0, std::memory_order_relaxed);
    for (int chunk = loop.chunks(); chunk < threads_; ++chunk) begin(chunk, round);
    round_.store(round, std::memory_order_release);
    while (helpers_.load(std::memory_order_relaxed) < threads_ - 1) {
        helpers_.fetch_add(1, std::memory_order_relaxed);
        call();
    }
    const int left = loop.chunks() - run_chunks(0, round);
    for (int look = 0; helped_.load(std::memory_order_acquire) != left; ++look) {
        if (look < looks_before_yield) {
            pause_thread();
        } else {
            std::this_thread::yield();
        }
    }
}

void LoopCrew::expect_home() noexcept {
    expected_.store(this_thread(), std::memory_order_relaxed);
}

bool LoopCrew::await_round(std::uint64_t seen, bool is_expected) const noexcept {
    int looks_with_ready_tasks = 0;
    for (int look = 0; look < looks_for_a_round; ++look) {
        if (round_.load(std::memory_order_acquire) != seen) return true;
        if (is_dismissed_.load(std::memory_order_relaxed)) return false;
        if (is_expected && expected_.load(std::memory_order_relaxed) == nullptr) return false;
        // A task that the thread before it goes on with is ready for a moment only.
        looks_with_ready_tasks = ready_.load(std::memory_order_relaxed) > 0 ? looks_with_ready_tasks + 1 : 0;
        if (looks_with_ready_tasks > looks_at_ready_tasks) return false;
        pause_thread();
    }
    return false;
}

void LoopCrew::serve() noexcept {
    if (runner_.load(std::memory_order_relaxed) != this_thread() && !is_dismissed_.load(std::memory_order_relaxed)) {
        int seat = 1;
        while (seat < threads_ && seats_[static_cast<std::size_t>(seat)].exchange(true, std::memory_order_acquire)) {
            ++seat;
        }
        const bool is_expected = expected_.load(std::memory_order_relaxed) == this_thread();
        std::uint64_t seen = 0;
        do {
            seen = round_.load(std::memory_order_acquire);
            const int count = run_chunks(seat % threads_, seen);
            if (count > 0) helped_.fetch_add(count, std::memory_order_release);
        } while (await_round(seen, is_expected));
        if (seat < threads_) seats_[static_cast<std::size_t>(seat)].store(false, std::memory_order_release);
    }
    helpers_.fetch_sub(1, std::memory_order_relaxed);
}

}  // namespace lancet::runtime
