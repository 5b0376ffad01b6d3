#include "lancet/runtime/simulate/frame_thread.hpp"

#include <utility>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {

FrameThread::FrameThread(std::function<void(const Frame&)> observer) : observer_(std::move(observer)) {
    if (!observer_) throw Error("frames: the observer is empty; expected a function");
    thread_ = std::thread([this] { work(); });
}

FrameThread::~FrameThread() {
    wait();
    state_.store(State::stopping);
    state_.notify_one();
    thread_.join();
}

Frame* FrameThread::begin() noexcept {
    return state_.load(std::memory_order_acquire) == State::free ? &frame_ : nullptr;
}

void FrameThread::submit() noexcept {
    state_.store(State::full, std::memory_order_release);
    state_.notify_one();
}

void FrameThread::wait() noexcept {
    state_.wait(State::full, std::memory_order_acquire);
}

void FrameThread::rethrow() {
    if (exception_) std::rethrow_exception(std::exchange(exception_, nullptr));
}

void FrameThread::work() {
    for (;;) {
        state_.wait(State::free, std::memory_order_acquire);
        if (state_.load(std::memory_order_acquire) == State::stopping) return;
        try {
            observer_(frame_);
            observed_.fetch_add(1, std::memory_order_relaxed);
        } catch (...) {
            exception_ = std::current_exception();
        }
        state_.store(State::free, std::memory_order_release);
        state_.notify_all();
    }
}

}  // namespace lancet::runtime
