#pragma once

#include <concepts>
#include <functional>
#include <memory>
#include <string>

namespace lancet::runtime {

class Scheduler;
class GraphTopology;

/// The named tasks of one step and what each waits for. Built once and run many times:
///
///     StepGraph graph;
///     auto forces = graph.task("forces", [&] { ... });
///     auto solve = graph.task("solve", [&] { ... });
///     auto frames = graph.task("frames", [&] { ... });
///     forces.precede(solve, frames);
///     graph.run(scheduler);
class StepGraph {
  public:
    /// Handle of a task; valid while its graph (or the graph that it was moved into) lives.
    class Task {
      public:
        /// Each of `later` starts after this task has ended. Saying so twice changes nothing.
        /// Throws lancet::Error if a task belongs to another graph, or the graph is running.
        template <std::same_as<Task>... Tasks>
        requires(sizeof...(Tasks) > 0) void precede(Tasks... later) const { (add_edge(later), ...); }

        const std::string& name() const;

      private:
        friend class StepGraph;
        Task(GraphTopology* topology, int index) : topology_(topology), index_(index) {}
        void add_edge(Task later) const;

        GraphTopology* topology_;
        int index_;
    };

    StepGraph();
    StepGraph(StepGraph&&) noexcept;
    StepGraph& operator=(StepGraph&&) noexcept;
    ~StepGraph();

    /// Adds a task. Throws lancet::Error if the name is empty or taken, the body empty, or the graph running.
    Task task(std::string name, std::function<void()> body);

    /// Number of tasks.
    int size() const noexcept;

    /// Throws lancet::Error, naming the tasks on the cycle, if tasks wait for each other in a circle.
    void validate() const;

    /// Runs every task once on the threads of `scheduler`, each after all tasks that precede it, and returns when all
    /// have ended. The first run after a change, or on another scheduler, prepares the execution; later ones reuse it
    /// and allocate nothing of ours.
    ///
    /// Tasks may call for_each_block of the same scheduler. After an exception no further task starts; it is rethrown
    /// (of several, the one whose task is first in topological order), and the graph can be run again.
    /// A graph run from a task of another graph on the same scheduler runs on the calling thread, task after task.
    /// Throws lancet::Error as validate() does, if this graph is running already, or if called from a loop body.
    void run(Scheduler& scheduler);

    /// The graph in the DOT language of Graphviz, tasks and edges in the order in which they were added.
    std::string to_dot() const;

  private:
    struct Prepared;

    std::unique_ptr<GraphTopology> topology_;
    std::unique_ptr<Prepared> prepared_;
};

}  // namespace lancet::runtime
