#include "lancet/runtime/schedule/graph_topology.hpp"

#include <algorithm>
#include <queue>
#include <utility>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/schedule/execution_context.hpp"
#include "lancet/runtime/schedule/flush_denormals.hpp"

namespace lancet::runtime {

void GraphTopology::require_idle() const {
    if (running) throw Error("step graph: tasks and edges cannot be added while the graph is running");
}

int GraphTopology::add_task(std::string name, std::function<void()> body) {
    require_idle();
    if (name.empty()) throw Error("step graph: a task needs a name");
    if (!body) throw Error("step graph: task '" + name + "' has no body");
    const auto same_name = [&](const Node& other) { return other.name == name; };
    if (std::any_of(nodes_.begin(), nodes_.end(), same_name)) {
        throw Error("step graph: there are two tasks named '" + name + "'; names must differ");
    }
    nodes_.push_back({std::move(name), std::move(body), {}, 0});
    ++version_;
    return size() - 1;
}

void GraphTopology::add_edge(int earlier, int later) {
    require_idle();
    auto& successors = nodes_[static_cast<std::size_t>(earlier)].successors;
    if (std::find(successors.begin(), successors.end(), later) != successors.end()) return;
    successors.push_back(later);
    ++nodes_[static_cast<std::size_t>(later)].predecessors;
    ++version_;
}

std::vector<int> GraphTopology::topological_order() const {
    std::vector<int> waiting(nodes_.size());
    std::priority_queue<int, std::vector<int>, std::greater<>> ready;
    for (int task = 0; task < size(); ++task) {
        waiting[static_cast<std::size_t>(task)] = predecessors(task);
        if (predecessors(task) == 0) ready.push(task);
    }
    std::vector<int> order;
    while (!ready.empty()) {
        const int task = ready.top();
        ready.pop();
        order.push_back(task);
        for (const int later : successors(task)) {
            if (--waiting[static_cast<std::size_t>(later)] == 0) ready.push(later);
        }
    }
    if (order.size() != nodes_.size()) throw Error("step graph: tasks wait in a circle: " + describe_cycle(waiting));
    return order;
}

// Every task left over waits for another one left over: walking back from any of them must meet a task twice.
std::string GraphTopology::describe_cycle(const std::vector<int>& waiting) const {
    const auto left_over = [&](int task) { return waiting[static_cast<std::size_t>(task)] > 0; };
    const auto some_predecessor = [&](int task) {
        for (int earlier = 0; earlier < size(); ++earlier) {
            const auto& later = successors(earlier);
            if (left_over(earlier) && std::find(later.begin(), later.end(), task) != later.end()) return earlier;
        }
        return -1;
    };
    std::vector<int> path;
    int task = 0;
    while (!left_over(task)) ++task;
    while (std::find(path.begin(), path.end(), task) == path.end()) {
        path.push_back(task);
        task = some_predecessor(task);
    }
    path.erase(path.begin(), std::find(path.begin(), path.end(), task));
    std::reverse(path.begin(), path.end());
    std::rotate(path.begin(), std::min_element(path.begin(), path.end()), path.end());
    std::string text;
    for (const int member : path) text += "'" + name(member) + "' -> ";
    return text + "'" + name(path.front()) + "'";
}

GraphExecution::GraphExecution(const GraphTopology& topology, const void* scheduler)
    : topology_(topology),
      scheduler_(scheduler),
      order_(topology.topological_order()),
      position_(static_cast<std::size_t>(topology.size())) {
    for (std::size_t position = 0; position < order_.size(); ++position) {
        position_[static_cast<std::size_t>(order_[position])] = static_cast<int>(position);
    }
}

void GraphExecution::run() {
    // A task that runs another graph keeps its thread: handing tasks to others and waiting for them could make this
    // thread take up a task of the outer graph.
    if (ExecutionContext::current().graph == scheduler_) {
        run_in_order();
    } else {
        run_tasks();
    }
    exception_.rethrow();
}

void GraphExecution::run_task(int task) noexcept {
    if (exception_.any()) return;
    const GraphScope scope(scheduler_);
    const FlushDenormals flush;
    try {
        topology_.body(task)();
    } catch (...) {
        exception_.record(position_[static_cast<std::size_t>(task)]);
    }
}

void GraphExecution::run_in_order() noexcept {
    for (const int task : order_) run_task(task);
}

}  // namespace lancet::runtime
