#pragma once

#include <optional>
#include <string>

#include "lancet/experiments/bar/worker.hpp"
#include "lancet/experiments/scaling/load.hpp"

namespace lancet::experiments::scaling {

/// What a worker prints, as one line of JSON: one run of a benchmark in a process of its own.
struct Report {
    bar::WorkerReport run;
    std::string state;                      ///< hash of all positions and velocities at the end, bit for bit
    std::optional<double> error_percent{};  ///< at error_time, of the length; missing without a converged solution
    Load load{};
    int cores = 1;           ///< that the process may use
    int pinned_threads = 0;  ///< held to one core
    std::string omp_wait_policy{};
    double peak_gflops = 0;        ///< multiply-adds of all threads; 0: not measured
    double read_gbytes_per_s = 0;  ///< of all threads, from as much memory as an iteration of the solver touches
};

/// One line of JSON without a line end.
[[nodiscard]] std::string to_line(const Report& report);

/// The report in `line`. Throws lancet::Error when a field is missing or has another type; `worker` names the program.
[[nodiscard]] Report report_from_line(const std::string& line, const std::string& worker);

}  // namespace lancet::experiments::scaling
