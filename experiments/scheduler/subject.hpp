#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "lancet/runtime/simulate/simulation.hpp"

namespace lancet::experiments::scheduler {

/// The Bar (Jerabkova 2007): 4 x 0.8 x 0.8 m, clamped at x = 0, hanging under gravity, in this many cells of five
/// elements each.
struct BarProblem {
    std::array<int, 3> cells{40, 8, 8};
    runtime::Settings settings{};

    std::int64_t elements() const noexcept { return std::int64_t{5} * cells[0] * cells[1] * cells[2]; }
};

/// What a step does beside the solve.
enum class Extras {
    nothing,
    frames,     ///< surfaces and frames at 30 Hz, observed by somebody
    everything  ///< frames; a tool with a blade close to the bar, collision at 200 Hz; a body that can be cut
};
/// "nothing", "frames" or "everything".
std::string_view to_string(Extras extras) noexcept;
/// The inverse. Throws lancet::Error for another text.
Extras extras_from_string(std::string_view text);

/// What the tasks of one step took, in seconds.
struct TaskSeconds {
    double frames = 0;         ///< surfaces and frames
    double frames_beside = 0;  ///< the part of it in which a stage of the body's step ran on another thread
    double side = 0;           ///< all tasks that are no stage of the body's step
    double all = 0;
};

/// One way to take the steps of a bar. The tool of `everything` touches nothing: the motion is that of the body alone.
class Subject {
  public:
    virtual ~Subject() = default;
    virtual void step() = 0;
    virtual std::vector<mesh::Point> positions() = 0;
    /// Of the last step; zeros where there are no tasks.
    virtual TaskSeconds task_seconds() const = 0;
    /// The tasks in the DOT language; empty where there are none.
    virtual std::string graph() = 0;
};

/// The body's step, its loops on the scheduler: phases of parallel loops, no tasks.
std::unique_ptr<Subject> make_loops(const BarProblem& problem, runtime::Scheduler& scheduler);
/// A Simulation: tasks on the scheduler, with loops inside.
std::unique_ptr<Subject> make_tasks(const BarProblem& problem, runtime::Scheduler& scheduler, Extras extras);

}  // namespace lancet::experiments::scheduler
