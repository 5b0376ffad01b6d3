#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "lancet/runtime/schedule/first_exception.hpp"

namespace lancet::runtime {

/// Tasks and edges of a StepGraph, as the schedulers see them. Tasks are numbered as they were added.
class GraphTopology {
  public:
    int size() const noexcept { return static_cast<int>(nodes_.size()); }
    const std::string& name(int task) const { return node(task).name; }
    const std::vector<int>& successors(int task) const { return node(task).successors; }
    int predecessors(int task) const { return node(task).predecessors; }

    /// Tasks in a fixed topological order: of those that could come next, the one added first. Throws lancet::Error,
    /// naming the tasks on the cycle, if there is none.
    std::vector<int> topological_order() const;

    /// Throws lancet::Error if the name is empty or taken, the body empty, or the graph running.
    int add_task(std::string name, std::function<void()> body);

    /// Throws lancet::Error if the graph is running.
    void add_edge(int earlier, int later);

    /// Changes whenever a task or an edge is added.
    int version() const noexcept { return version_; }

    const std::function<void()>& body(int task) const { return node(task).body; }

    std::atomic<bool> running{false};

  private:
    struct Node {
        std::string name;
        std::function<void()> body;
        std::vector<int> successors;
        int predecessors = 0;
    };

    const Node& node(int task) const { return nodes_[static_cast<std::size_t>(task)]; }
    void require_idle() const;
    std::string describe_cycle(const std::vector<int>& waiting) const;

    std::vector<Node> nodes_;
    int version_ = 0;
};

/// Runs the tasks of one topology on one scheduler. Derived classes decide where and when; this class knows how a
/// single task runs and in which order the serial path takes them.
class GraphExecution {
  public:
    GraphExecution(const GraphTopology& topology, const void* scheduler);
    GraphExecution(const GraphExecution&) = delete;
    GraphExecution& operator=(const GraphExecution&) = delete;
    virtual ~GraphExecution() = default;

    /// Runs every task once; throws what a task threw.
    void run();

  protected:
    /// Runs every task once, by calling run_task in an order that respects the edges.
    virtual void run_tasks() = 0;

    /// Runs one task on the calling thread, unless a task has thrown before.
    void run_task(int task) noexcept;

    /// Runs all tasks on the calling thread in the fixed order.
    void run_in_order() noexcept;

    const GraphTopology& topology() const noexcept { return topology_; }

  private:
    const GraphTopology& topology_;
    const void* scheduler_;
    std::vector<int> order_;
    std::vector<int> position_;  ///< of each task in order_
    FirstException exception_;
};

}  // namespace lancet::runtime
