#pragma once

#include <atomic>
#include <mutex>
#include <vector>

#include "lancet/runtime/schedule/function_reference.hpp"
#include "lancet/runtime/schedule/loop.hpp"
#include "lancet/runtime/schedule/spin_then_sleep.hpp"

namespace lancet::runtime {

/// What the threads of a team share while they run a graph: the tasks that are ready, and the loops of running tasks
/// of which chunks are still to be had.
class WorkQueue {
  public:
    /// `looks`: see SpinThenSleep.
    explicit WorkQueue(int looks) : changed_(looks) {}

    /// Starts a graph of `tasks` tasks. `ready` becomes the list of the ready ones; it belongs to the queue until all
    /// tasks are done and needs capacity for all of them.
    void open(int tasks, std::vector<int>& ready);

    /// Runs tasks (run_task) and, when none is ready, chunks of the loops of others, until all tasks are done.
    /// run_task(task, ready) runs one task; it is called without the lock. make_ready(task) is called with the lock:
    /// it adds the tasks that `task` was the last to be waited for by to the ready list.
    void serve(FunctionReference<void(int)> run_task, FunctionReference<void(int)> make_ready);

    /// Runs the chunks of `loop`, with the help of the threads that have nothing else to do. The caller runs chunks
    /// of this loop only.
    void share(ChunkedLoop& loop);

  private:
    /// A loop that is being shared; lives on the stack of the thread that shares it.
    struct SharedLoop {
        ChunkedLoop* loop;
        int unclaimed;     ///< the first chunk that nobody has taken
        int unfinished;    ///< number of chunks that have not ended
        SharedLoop* next;  ///< in the list of loops with unclaimed chunks
    };

    void run_one_chunk(SharedLoop& shared, std::unique_lock<std::mutex>& lock);
    void announce_change();
    void wait_for_change(std::unique_lock<std::mutex>& lock);

    std::mutex mutex_;  ///< guards what follows, changes_ being written under it
    int unfinished_tasks_ = 0;
    std::vector<int>* ready_ = nullptr;
    SharedLoop* loops_ = nullptr;
    std::atomic<unsigned> changes_{0};
    SpinThenSleep changed_;
};

}  // namespace lancet::runtime
