#include "lancet/runtime/schedule/step_graph.hpp"

#include <utility>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/schedule/execution_context.hpp"
#include "lancet/runtime/schedule/graph_topology.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::runtime {

/// The execution that was used last, and what it was prepared for.
struct StepGraph::Prepared {
    std::shared_ptr<const int> scheduler;
    int version = 0;
    std::unique_ptr<GraphExecution> execution;
};

namespace {

/// Marks a graph as running, once at a time.
class RunningMark {
  public:
    explicit RunningMark(std::atomic<bool>& running) : running_(running) {
        if (running_.exchange(true)) throw Error("step graph: run was called while the graph is running");
    }
    RunningMark(const RunningMark&) = delete;
    RunningMark& operator=(const RunningMark&) = delete;
    ~RunningMark() { running_ = false; }

  private:
    std::atomic<bool>& running_;
};

std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char character : text) {
        if (character == '"' || character == '\\') result += '\\';
        result += character;
    }
    return result + '"';
}

}  // namespace

StepGraph::StepGraph() : topology_(std::make_unique<GraphTopology>()), prepared_(std::make_unique<Prepared>()) {}
StepGraph::StepGraph(StepGraph&&) noexcept = default;
StepGraph& StepGraph::operator=(StepGraph&&) noexcept = default;
StepGraph::~StepGraph() = default;

StepGraph::Task StepGraph::task(std::string name, std::function<void()> body) {
    return {topology_.get(), topology_->add_task(std::move(name), std::move(body))};
}

const std::string& StepGraph::Task::name() const {
    return topology_->name(index_);
}

void StepGraph::Task::add_edge(Task later) const {
    if (later.topology_ != topology_) {
        throw Error("step graph: task '" + name() + "' cannot precede '" + later.name() + "' of another graph");
    }
    topology_->add_edge(index_, later.index_);
}

int StepGraph::size() const noexcept {
    return topology_->size();
}

void StepGraph::validate() const {
    topology_->topological_order();
}

void StepGraph::run(Scheduler& scheduler) {
    if (ExecutionContext::current().loop == &scheduler) {
        throw Error("step graph: run was called from a loop body of the same scheduler; call it from a task");
    }
    const RunningMark mark(topology_->running);
    if (prepared_->scheduler != scheduler.identity() || prepared_->version != topology_->version()) {
        *prepared_ = {};
        auto execution = scheduler.prepare(*topology_);
        *prepared_ = {scheduler.identity(), topology_->version(), std::move(execution)};
    }
    prepared_->execution->run();
}

std::string StepGraph::to_dot() const {
    std::string text = "digraph step {\n";
    for (int task = 0; task < size(); ++task) text += "    " + quoted(topology_->name(task)) + ";\n";
    for (int task = 0; task < size(); ++task) {
        for (const int later : topology_->successors(task)) {
            text += "    " + quoted(topology_->name(task)) + " -> " + quoted(topology_->name(later)) + ";\n";
        }
    }
    return text + "}\n";
}

}  // namespace lancet::runtime
