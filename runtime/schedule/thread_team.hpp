#pragma once

#include <atomic>
#include <thread>
#include <vector>

#include "lancet/runtime/schedule/function_reference.hpp"
#include "lancet/runtime/schedule/spin_then_sleep.hpp"

namespace lancet::runtime {

/// Persistent std::threads that do one duty at a time together with the thread that calls.
class ThreadTeam {
  public:
    /// Starts threads - 1 workers.
    explicit ThreadTeam(int threads);
    ThreadTeam(const ThreadTeam&) = delete;
    ThreadTeam& operator=(const ThreadTeam&) = delete;
    ~ThreadTeam();

    int threads() const noexcept { return threads_; }

    /// How often a thread of this team looks for something to do before it sleeps (see SpinThenSleep): not at all
    /// where threads share cores.
    int looks() const noexcept { return looks_; }

    /// The sole use of a team while it lives, if the team was free when it was made.
    class Lease {
      public:
        explicit Lease(ThreadTeam& team) noexcept
            : team_(team), granted_(!team.taken_.exchange(true, std::memory_order_acquire)) {}
        Lease(const Lease&) = delete;
        Lease& operator=(const Lease&) = delete;
        ~Lease() {
            if (granted_) team_.taken_.store(false, std::memory_order_release);
        }

        bool granted() const noexcept { return granted_; }

        /// Calls duty(thread) on every thread of the team, the caller being thread 0, and returns when all have
        /// returned. `duty` must not throw.
        void run(FunctionReference<void(int)> duty) { team_.run(duty); }

      private:
        ThreadTeam& team_;
        bool granted_;
    };

  private:
    void run(FunctionReference<void(int)> duty);
    void start_round();
    void stop();
    void work(int worker);

    int threads_;
    int looks_;
    std::atomic<bool> taken_{false};
    std::atomic<bool> stopping_{false};
    const FunctionReference<void(int)>* duty_ = nullptr;  ///< published by round_
    alignas(64) std::atomic<unsigned> round_{0};          ///< raised to start a duty; apart from what workers write
    SpinThenSleep started_;
    alignas(64) std::atomic<int> unfinished_{0};
    SpinThenSleep finished_;
    std::vector<std::thread> workers_;
};

}  // namespace lancet::runtime
