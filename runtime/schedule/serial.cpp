#include "lancet/runtime/schedule/flush_denormals.hpp"
#include "lancet/runtime/schedule/graph_topology.hpp"
#include "lancet/runtime/schedule/implementations.hpp"
#include "lancet/runtime/schedule/loop.hpp"

namespace lancet::runtime {
namespace {

class SerialExecution final : public GraphExecution {
  public:
    using GraphExecution::GraphExecution;

  protected:
    void run_tasks() override { run_in_order(); }
};

class Serial final : public Scheduler {
  public:
    SchedulerKind kind() const noexcept override { return SchedulerKind::serial; }
    int threads() const noexcept override { return 1; }

    void for_each_block(int blocks, FunctionReference<void(int)> body) override {
        require_block_count(blocks);
        run_blocks_here(this, blocks, body);
    }

    std::unique_ptr<GraphExecution> prepare(const GraphTopology& topology) override {
        return std::make_unique<SerialExecution>(topology, this);
    }
};

}  // namespace

std::unique_ptr<Scheduler> make_serial() {
    return std::make_unique<Serial>();
}

}  // namespace lancet::runtime
