#include "lancet/runtime/schedule/thread_team.hpp"

namespace lancet::runtime {
namespace {

int looks_before_sleep(int threads) {
    constexpr int some_tens_of_microseconds = 2000;
    return threads <= static_cast<int>(std::thread::hardware_concurrency()) ? some_tens_of_microseconds : 0;
}

}  // namespace

ThreadTeam::ThreadTeam(int threads)
    : threads_(threads), looks_(looks_before_sleep(threads)), started_(looks_), finished_(looks_) {
    workers_.reserve(static_cast<std::size_t>(threads - 1));
    try {
        for (int worker = 1; worker < threads; ++worker) {
            workers_.emplace_back([this, worker] { work(worker); });
        }
    } catch (...) {
        stop();
        throw;
    }
}

ThreadTeam::~ThreadTeam() {
    stop();
}

void ThreadTeam::run(FunctionReference<void(int)> duty) {
    duty_ = &duty;
    unfinished_.store(threads_ - 1, std::memory_order_relaxed);
    start_round();
    duty(0);
    finished_.wait([this] { return unfinished_.load(std::memory_order_acquire) == 0; });
}

void ThreadTeam::start_round() {
    round_.fetch_add(1, std::memory_order_acq_rel);
    started_.notify();
}

void ThreadTeam::stop() {
    stopping_ = true;
    start_round();
    for (std::thread& worker : workers_) worker.join();
}

void ThreadTeam::work(int worker) {
    for (unsigned seen = 0;; ++seen) {
        started_.wait([&] { return round_.load(std::memory_order_acquire) != seen; });
        if (stopping_) return;
        (*duty_)(worker);
        if (unfinished_.fetch_sub(1, std::memory_order_acq_rel) == 1) finished_.notify();
    }
}

}  // namespace lancet::runtime
