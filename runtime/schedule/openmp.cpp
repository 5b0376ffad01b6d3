#include <atomic>
#include <memory>

#include "lancet/runtime/schedule/graph_topology.hpp"
#include "lancet/runtime/schedule/implementations.hpp"
#include "lancet/runtime/schedule/loop.hpp"

namespace lancet::runtime {
namespace {

/// The step graph as OpenMP tasks: the task that ends last among those another one waits for creates that one. That
/// counts; `depend` clauses are looked up in hash tables, under a lock.
class OpenMpExecution final : public GraphExecution {
  public:
    OpenMpExecution(const GraphTopology& topology, const void* scheduler, int threads)
        : GraphExecution(topology, scheduler),
          threads_(threads),
          waiting_for_(std::make_unique<std::atomic<int>[]>(static_cast<std::size_t>(topology.size()))) {}

  protected:
    void run_tasks() override {
        for (int task = 0; task < topology().size(); ++task) {
            waiting_for(task).store(topology().predecessors(task), std::memory_order_relaxed);
        }
#pragma omp parallel num_threads(threads_)
#pragma omp single
        for (int task = 0; task < topology().size(); ++task) {
            if (topology().predecessors(task) == 0) create(task);
        }
    }

  private:
    std::atomic<int>& waiting_for(int task) {
        return waiting_for_[static_cast<std::size_t>(task)];
    }

    void create(int task) {
#pragma omp task firstprivate(task)
        {
            run_task(task);
            for (const int later : topology().successors(task)) {
                if (waiting_for(later).fetch_sub(1, std::memory_order_acq_rel) == 1) create(later);
            }
        }
    }

    int threads_;
    std::unique_ptr<std::atomic<int>[]> waiting_for_;
};

/// The plain way to use OpenMP: one parallel region for each loop, on the team that the runtime keeps.
class OpenMp final : public Scheduler {
  public:
    explicit OpenMp(int threads) : threads_(threads) {}

    SchedulerKind kind() const noexcept override { return SchedulerKind::openmp; }
    int threads() const noexcept override { return threads_; }

    void for_each_block(int blocks, FunctionReference<void(int)> body) override {
        require_block_count(blocks);
        const ExecutionContext& context = ExecutionContext::current();
        if (threads_ == 1 || blocks <= 1 || context.loop == this) {
            run_blocks_here(this, blocks, body);
            return;
        }
        ChunkedLoop loop(this, blocks, threads_, body);
        const int chunks = loop.chunks();
        if (context.graph == this) {
            // The tasks of the graph are tied, so a thread that waits here takes up tasks of this group only.
#pragma omp taskgroup
            {
                for (int chunk = 1; chunk < chunks; ++chunk) {
#pragma omp task firstprivate(chunk) shared(loop)
                    loop.run_chunk(chunk);
                }
                loop.run_chunk(0);
            }
        } else {
#pragma omp parallel for schedule(static) num_threads(threads_)
            for (int chunk = 0; chunk < chunks; ++chunk) loop.run_chunk(chunk);
        }
        loop.rethrow();
    }

    std::unique_ptr<GraphExecution> prepare(const GraphTopology& topology) override {
        return std::make_unique<OpenMpExecution>(topology, this, threads_);
    }

  private:
    int threads_;
};

}  // namespace

std::unique_ptr<Scheduler> make_openmp(int threads) {
    return std::make_unique<OpenMp>(threads);
}

}  // namespace lancet::runtime
