#include "lancet/runtime/schedule/work_queue.hpp"

namespace lancet::runtime {

void WorkQueue::open(int tasks, std::vector<int>& ready) {
    const std::scoped_lock lock(mutex_);
    unfinished_tasks_ = tasks;
    ready_ = &ready;
}

void WorkQueue::serve(FunctionReference<void(int)> run_task, FunctionReference<void(int)> make_ready) {
    std::unique_lock lock(mutex_);
    while (unfinished_tasks_ > 0) {
        if (!ready_->empty()) {
            const int task = ready_->back();
            ready_->pop_back();
            lock.unlock();
            run_task(task);
            lock.lock();
            make_ready(task);
            --unfinished_tasks_;
            announce_change();
        } else if (loops_ != nullptr) {
            run_one_chunk(*loops_, lock);
        } else {
            wait_for_change(lock);
        }
    }
}

void WorkQueue::share(ChunkedLoop& loop) {
    std::unique_lock lock(mutex_);
    SharedLoop shared{&loop, 0, loop.chunks(), loops_};
    loops_ = &shared;
    announce_change();
    while (shared.unclaimed < loop.chunks()) run_one_chunk(shared, lock);
    while (shared.unfinished > 0) wait_for_change(lock);
}

void WorkQueue::run_one_chunk(SharedLoop& shared, std::unique_lock<std::mutex>& lock) {
    const int chunk = shared.unclaimed++;
    if (shared.unclaimed == shared.loop->chunks()) {
        SharedLoop** link = &loops_;
        while (*link != &shared) link = &(*link)->next;
        *link = shared.next;
    }
    lock.unlock();
    shared.loop->run_chunk(chunk);
    lock.lock();
    if (--shared.unfinished == 0) announce_change();
}

void WorkQueue::announce_change() {
    changes_.fetch_add(1, std::memory_order_acq_rel);
    changed_.notify();
}

void WorkQueue::wait_for_change(std::unique_lock<std::mutex>& lock) {
    const unsigned seen = changes_.load(std::memory_order_acquire);
    lock.unlock();
    changed_.wait([&] { return changes_.load(std::memory_order_acquire) != seen; });
    lock.lock();
}

}  // namespace lancet::runtime
