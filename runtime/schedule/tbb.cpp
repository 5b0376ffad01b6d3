#include <algorithm>
#include <atomic>
#include <deque>
#include <optional>
#include <thread>
#include <vector>

#include <oneapi/tbb/flow_graph.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include "lancet/runtime/schedule/graph_topology.hpp"
#include "lancet/runtime/schedule/implementations.hpp"
#include "lancet/runtime/schedule/loop.hpp"
#include "lancet/runtime/schedule/loop_crew.hpp"

namespace lancet::runtime {
namespace {

/// For each task the number of tasks in the longest chain that begins with it.
std::vector<int> longest_chains(const GraphTopology& topology) {
    std::vector<int> longest(static_cast<std::size_t>(topology.size()), 1);
    const std::vector<int> order = topology.topological_order();
    for (auto task = order.rbegin(); task != order.rend(); ++task) {
        int& of_task = longest[static_cast<std::size_t>(*task)];
        for (const int later : topology.successors(*task)) {
            of_task = std::max(of_task, longest[static_cast<std::size_t>(later)] + 1);
        }
    }
    return longest;
}

/// The step graph as a flow graph, built once. It belongs to the arena that it is built in.
class TbbExecution final : public GraphExecution {
  public:
    TbbExecution(const GraphTopology& topology, const void* scheduler, tbb::task_arena& arena, LoopCrew& crew)
        : GraphExecution(topology, scheduler),
          arena_(arena),
          crew_(crew),
          waits_for_(static_cast<std::size_t>(topology.size())) {
        arena_.execute([this] { build(); });
    }

  protected:
    void run_tasks() override {
        for (int task = 0; task < topology().size(); ++task) {
            waits_for_[static_cast<std::size_t>(task)].store(topology().predecessors(task), std::memory_order_relaxed);
            if (topology().predecessors(task) == 0) crew_.count_ready(1);
        }
        left_.store(topology().size(), std::memory_order_relaxed);
        crew_.expect_home();
        arena_.execute([this] {
            start_->try_put(Message());
            graph_->wait_for_all();
        });
    }

  private:
    using Message = tbb::flow::continue_msg;

    void build() {
        graph_.emplace();
        start_.emplace(*graph_);
        for (int task = 0; task < topology().size(); ++task) {
            nodes_.emplace_back(*graph_, [this, task](const Message&) { run_and_count(task); });
        }
        // Of the tasks that become ready at a time, a thread goes on with the one whose edge is the last, and leaves
        // the others to whoever comes: the longest chain of tasks must not wait for a thread that comes late.
        const std::vector<int> longest = longest_chains(topology());
        const auto add_edges = [&](auto& from, std::vector<int> tasks) {
            std::ranges::stable_sort(tasks, {}, [&](int task) { return longest[static_cast<std::size_t>(task)]; });
            for (const int task : tasks) tbb::flow::make_edge(from, nodes_[static_cast<std::size_t>(task)]);
        };
        std::vector<int> first;
        for (int task = 0; task < topology().size(); ++task) {
            if (topology().predecessors(task) == 0) first.push_back(task);
            add_edges(nodes_[static_cast<std::size_t>(task)], topology().successors(task));
        }
        add_edges(*start_, first);
    }

    /// What waits for a thread is not known outside of a flow graph, so it is counted along.
    void run_and_count(int task) {
        crew_.count_ready(-1);
        run_task(task);
        for (const int later : topology().successors(task)) {
            if (waits_for_[static_cast<std::size_t>(later)].fetch_sub(1, std::memory_order_relaxed) == 1) {
                crew_.count_ready(1);
            }
        }
        if (left_.fetch_sub(1, std::memory_order_relaxed) == 1) crew_.send_home();
    }

    tbb::task_arena& arena_;
    LoopCrew& crew_;
    std::vector<std::atomic<int>> waits_for_;  ///< [task] tasks before it that have not ended
    std::atomic<int> left_{0};                 ///< tasks that have not ended
    std::optional<tbb::flow::graph> graph_;
    std::optional<tbb::flow::broadcast_node<Message>> start_;
    std::deque<tbb::flow::continue_node<Message>> nodes_;  // a deque: nodes are neither copied nor moved
};

class Tbb final : public Scheduler {
  public:
    explicit Tbb(int threads) : threads_(threads), arena_(threads), crew_(threads) {
        // oneTBB starts no more workers than the machine has cores unless it is told to.
        if (threads > tbb::info::default_concurrency()) {
            more_threads_.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
        }
        // An arena captures the floating-point mode of the thread that makes it.
        const FlushDenormals flush;
        arena_.initialize();
        arena_.execute([this] { calls_.emplace(); });
    }

    ~Tbb() noexcept override {
        crew_.dismiss();
        arena_.execute([this] { calls_->wait(); });
    }

    SchedulerKind kind() const noexcept override { return SchedulerKind::tbb; }
    int threads() const noexcept override { return threads_; }

    // One chunk for each thread. Measured on two cores (oneTBB 2021.8): static_partitioner, simple_partitioner,
    // affinity_partitioner and task_group over such chunks all end 1.5 to 3 us after the ideal time, one task for
    // each block is slower; of these, static_partitioner alone keeps blocks on their thread, and so in its cache.
    // Threads that stay from loop to loop do both, and are there in time.
    void for_each_block(int blocks, FunctionReference<void(int)> body) override {
        require_block_count(blocks);
        if (threads_ == 1 || blocks <= 1 || ExecutionContext::current().loop == this) {
            run_blocks_here(this, blocks, body);
            return;
        }
        ChunkedLoop loop(this, blocks, threads_, body);
        // Where threads share cores, one that looks for work takes the time of one that has some.
        if (const LoopCrew::Lease lease(crew_); lease.is_granted() && !shares_cores_) {
            const auto call = [this] { arena_.execute([this] { calls_->run([this] { crew_.serve(); }); }); };
            crew_.run(loop, call);
        } else {
            run_by_tasks(loop);
        }
        loop.rethrow();
    }

    std::unique_ptr<GraphExecution> prepare(const GraphTopology& topology) override {
        return std::make_unique<TbbExecution>(topology, this, arena_, crew_);
    }

  private:
    void run_by_tasks(ChunkedLoop& loop) {
        arena_.execute([&loop] {
            // Without isolation the thread that waits for the last chunk may take up a long task of the step graph.
            tbb::this_task_arena::isolate([&loop] {
                tbb::parallel_for(
                    0, loop.chunks(), [&loop](int chunk) { loop.run_chunk(chunk); }, tbb::static_partitioner());
            });
        });
    }

    int threads_;
    bool shares_cores_ = threads_ > static_cast<int>(std::thread::hardware_concurrency());
    std::optional<tbb::global_control> more_threads_;
    tbb::task_arena arena_;
    LoopCrew crew_;
    std::optional<tbb::task_group> calls_;  ///< of helpers
};

}  // namespace

std::unique_ptr<Scheduler> make_tbb(int threads) {
    return std::make_unique<Tbb>(threads);
}

}  // namespace lancet::runtime
