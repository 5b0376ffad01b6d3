#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lancet/experiments/scheduler/worker.hpp"

namespace lancet::experiments::scheduler {

/// A value with what repetitions, each in a process of its own, make of it.
struct Spread {
    double lowest = 0;
    double middle = 0;  ///< their median
    double highest = 0;
};
/// Of at least one value.
Spread spread(std::span<const double> values);
/// Whether two differ by less than they vary.
inline bool overlap(const Spread& a, const Spread& b) noexcept {
    return a.lowest <= b.highest && b.lowest <= a.highest;
}

/// One form of the step, measured: a row of the table.
struct Measured {
    std::int64_t elements = 0;
    int threads = 1;
    std::string form{};
    Extras extras = Extras::nothing;
    std::vector<double> seconds{};  ///< of every step of every repetition
    Spread to_serial{};             ///< step over the same step on one thread without a scheduler, in the same process
    Spread to_bare{};               ///< step over the same step without a graph, on the same scheduler and threads
    Spread frames{};                ///< s, time of the frames' tasks in a step; of a form with frames
    Spread hidden{};                ///< share of that time by which the step is not longer than without frames
    Spread beside{};                ///< share of that time in which a stage of the body ran on another thread
    /// Most that can be hidden on two threads. A solve that takes s of the serial time on both goes on at the speed s
    /// on one of them while the other draws: a task of length t makes the step longer by (1 - s) t at least.
    Spread hidden_at_most{};
    Spread side{};   ///< work of all side tasks over the bare step; of a form with everything
    Spread graph{};  ///< time of the step outside of its tasks over the bare step; for one thread
    int tasks = 0;
    double seconds_per_task = 0;  ///< of an empty graph
    bool bit_identical = false;
};

/// "graph", "loops", "openmp-tasks", "openmp-loops", "serial-tasks" or "serial".
std::string form_name(runtime::SchedulerKind kind, bool is_tasks);

/// The rows of one bar, scheduler and number of threads from the reports of its processes; `motion` is the checksum
/// that all motions must have.
std::vector<Measured> evaluate(const WorkerJob& job, std::span<const WorkerReport> reports, const std::string& motion);

}  // namespace lancet::experiments::scheduler
