#include <vector>

#include "lancet/runtime/schedule/graph_topology.hpp"
#include "lancet/runtime/schedule/implementations.hpp"
#include "lancet/runtime/schedule/loop.hpp"
#include "lancet/runtime/schedule/thread_team.hpp"
#include "lancet/runtime/schedule/work_queue.hpp"

namespace lancet::runtime {
namespace {

/// The step graph on a team of threads that all serve one queue.
class StdThreadsExecution final : public GraphExecution {
  public:
    StdThreadsExecution(const GraphTopology& topology, const void* scheduler, ThreadTeam& team, WorkQueue& queue)
        : GraphExecution(topology, scheduler),
          team_(team),
          queue_(queue),
          waiting_for_(static_cast<std::size_t>(topology.size())) {
        ready_.reserve(waiting_for_.size());
    }

  protected:
    void run_tasks() override {
        ThreadTeam::Lease lease(team_);
        if (team_.threads() == 1 || !lease.granted()) {
            run_in_order();
            return;
        }
        for (int task = 0; task < topology().size(); ++task) {
            waiting_for_[static_cast<std::size_t>(task)] = topology().predecessors(task);
            if (topology().predecessors(task) == 0) ready_.push_back(task);
        }
        queue_.open(topology().size(), ready_);
        lease.run([this](int) {
            queue_.serve([this](int task) { run_task(task); }, [this](int task) { make_ready(task); });
        });
    }

  private:
    void make_ready(int task) {
        for (const int later : topology().successors(task)) {
            if (--waiting_for_[static_cast<std::size_t>(later)] == 0) ready_.push_back(later);
        }
    }

    ThreadTeam& team_;
    WorkQueue& queue_;
    std::vector<int> waiting_for_;
    std::vector<int> ready_;
};

/// Workers of our own: every synchronisation is visible to the thread sanitizer, unlike that inside the runtimes.
class StdThreads final : public Scheduler {
  public:
    explicit StdThreads(int threads) : team_(threads), queue_(team_.looks()) {}

    SchedulerKind kind() const noexcept override { return SchedulerKind::threads; }
    int threads() const noexcept override { return team_.threads(); }

    void for_each_block(int blocks, FunctionReference<void(int)> body) override {
        require_block_count(blocks);
        const ExecutionContext& context = ExecutionContext::current();
        if (threads() == 1 || blocks <= 1 || context.loop == this) {
            run_blocks_here(this, blocks, body);
            return;
        }
        ChunkedLoop loop(this, blocks, threads(), body);
        if (context.graph == this) {
            queue_.share(loop);
        } else {
            ThreadTeam::Lease lease(team_);
            if (!lease.granted()) {  // two threads from outside use one scheduler: the later one works alone
                run_blocks_here(this, blocks, body);
                return;
            }
            lease.run([&loop](int thread) {
                if (thread < loop.chunks()) loop.run_chunk(thread);
            });
        }
        loop.rethrow();
    }

    std::unique_ptr<GraphExecution> prepare(const GraphTopology& topology) override {
        return std::make_unique<StdThreadsExecution>(topology, this, team_, queue_);
    }

  private:
    ThreadTeam team_;
    WorkQueue queue_;
};

}  // namespace

std::unique_ptr<Scheduler> make_std_threads(int threads) {
    return std::make_unique<StdThreads>(threads);
}

}  // namespace lancet::runtime
