#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lancet/experiments/scaling/settings.hpp"

namespace lancet::experiments::scaling {

/// What one worker process is to do.
struct Job {
    std::string benchmark;
    int elements = 0;  ///< asked for; the mesh has about as many
    int steps = 0;
    std::string setting;    ///< default or original
    std::string scheduler;  ///< serial, openmp, tbb
    int threads = 1;
    std::string isa, scalar, matrix, scatter;
    /// One block with all nodes, serial: elements add to nodes one after the other, without copies, colors, slots
    /// or merging, with as fine a coarse space. What a program without threads would do, and so what threads have to
    /// beat.
    bool is_natural_order = false;

    friend bool operator==(const Job&, const Job&) = default;
    /// For progress and messages.
    [[nodiscard]] std::string label() const;
};

/// The worker's options for a job.
[[nodiscard]] std::vector<std::string> worker_arguments(const Job& job);

/// A row of a series: which job it shows, and what it is compared with. Places in Plan::jobs.
struct Entry {
    std::string series;
    std::size_t job = 0;
    std::size_t one_thread = 0;     ///< the same scheduler on one thread; in series weak with one thread's elements
    std::size_t natural_order = 0;  ///< serial, in natural order; in series weak with one thread's elements
    std::size_t same_blocks = 0;    ///< the serial scheduler on the same blocks: what must be equal bit for bit
};

/// Everything there is to measure: each job once, however many rows show it.
struct Plan {
    std::vector<Job> jobs;
    std::vector<Entry> entries;
};

[[nodiscard]] Plan make_plan(const ScalingSettings& settings);

}  // namespace lancet::experiments::scaling
