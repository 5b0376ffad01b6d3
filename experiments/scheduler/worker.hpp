#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lancet/experiments/scheduler/subject.hpp"

namespace lancet::experiments::scheduler {

/// What one worker process measures.
struct WorkerJob {
    BarProblem problem{};
    runtime::SchedulerKind kind = runtime::SchedulerKind::serial;
    int threads = 1;
    int runs = 1;  ///< of `steps` steps each, from the start
    int steps = 125;
    int block = 10;  ///< steps that one subject takes before the next has its turn
    int window = 1;  ///< steps that are compared as one: short steps have a frame or a collision in some of them only
};

/// How one subject did. All vectors have an entry for each step of each run.
struct SubjectReport {
    bool is_tasks = false;
    std::string extras = "nothing";
    std::vector<double> seconds{};
    std::vector<double> frame_seconds{};         ///< in tasks of surfaces and frames; 0 where nobody observes tasks
    std::vector<double> frame_seconds_beside{};  ///< of these, while a stage of the body ran on another thread
    std::vector<double> side_seconds{};          ///< in all tasks but the stages of the body
    std::vector<double> task_seconds{};          ///< in all tasks
    bool bit_identical = false;                  ///< positions after every run equal those of the first subject
    int tasks = 0;                               ///< of its graph; 0: none
    double empty_graph_seconds = 0;              ///< of a run of the same graph without work
};

struct WorkerReport {
    std::string motion{};                   ///< a checksum of the first subject's last positions
    std::vector<SubjectReport> subjects{};  ///< the first: the body's step on one thread, without a scheduler
};

/// Takes the steps of all subjects in turn, block by block, so that what disturbs the machine meets all alike, and the
/// same step of each can be compared. Before each block there is a pause in which the waiting threads of OpenMP stop to
/// spin, so that no subject runs beside another's.
WorkerReport measure(const WorkerJob& job);

/// One line of JSON, without its end.
std::string to_line(const WorkerReport& report);
/// The inverse. Throws lancet::Error for what it cannot read.
WorkerReport report_from_line(const std::string& line);

}  // namespace lancet::experiments::scheduler
