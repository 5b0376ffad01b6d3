#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "lancet/experiments/bar/problem.hpp"

namespace lancet::experiments::bar {

/// The protocol between the program `bar` and its workers: a worker solves the whole problem once and prints this
/// report as one line of JSON. Times are wall-clock seconds; nothing that a step needs is outside of seconds_total.
struct WorkerReport {
    std::string method;     ///< lancet, eigen, thesis
    std::string variant;    ///< preconditioner, rotation method and the like, for people
    std::string operator_;  ///< how y = A x is computed; "operator" in JSON
    std::string scalar;     ///< float or double
    std::string isa;        ///< instruction set of the hot loops; "native" for a program built for this machine
    std::string scheduler;
    int threads = 1;
    std::int64_t elements = 0;
    std::int64_t nodes = 0;
    std::int64_t steps = 0;
    double seconds_total = 0;   ///< all steps, without set-up and snapshots
    double seconds_setup = 0;   ///< from the mesh to the first step
    double seconds_forces = 0;  ///< rotations, forces, assembly
    double seconds_solve = 0;   ///< preconditioner and conjugate gradients
    double seconds_rest = 0;    ///< seconds_total without the two above
    std::int64_t cg_iterations_total = 0;
    std::int64_t repeats_total = 0;  ///< steps repeated by an energy safeguard
    std::int64_t bytes = 0;          ///< of the solver's own arrays, the mesh it was given not counted
    double solve_flops = 0;          ///< arithmetic operations of the solves, counted from the formulas
    double solve_bytes = 0;          ///< memory traffic of the solves if each array is streamed once per pass
    double energy_final = 0;         ///< J, see energy()
};

/// The report of a baseline, compiled for this machine, before it runs on a problem: scheduler "serial" on one thread
/// and "openmp" on more, no variant, and the problem's number of steps.
[[nodiscard]] WorkerReport baseline_report(const std::string& method, const std::string& operator_name,
                                           const std::string& scalar, int threads, const Problem& problem);

/// One line of JSON without a line end.
[[nodiscard]] std::string to_line(const WorkerReport& report);

/// The report in `line`. Throws lancet::Error when a field is missing or has another type; `worker` names the program.
[[nodiscard]] WorkerReport report_from_line(const std::string& line, const std::string& worker);

/// At which times node positions are asked for, and where they go.
struct SnapshotOptions {
    std::string file;           ///< empty: nowhere
    std::vector<double> times;  ///< s, ascending, multiples of the time step
};

/// Adds --snapshots and --snapshot-times.
void add_snapshot_options(CLI::App& app, SnapshotOptions& options);

/// The snapshots of one run: node positions, x, y, z of every node in the user's numbering, one block per time.
class Snapshots {
  public:
    /// Throws lancet::Error for times without a file or the reverse, and for times that are not an ascending list of
    /// multiples of the time step within the simulated time.
    Snapshots(const SnapshotOptions& options, const Problem& problem);

    /// Whether positions are asked for after `steps_done` steps.
    [[nodiscard]] bool wanted(int steps_done) const;

    /// Keeps the positions of the next time.
    void add(std::span<const double> positions);

    /// Writes what was added to the file: little-endian doubles without a heading. The file appears by rename.
    void write() const;

  private:
    std::filesystem::path file_;
    std::vector<int> steps_;
    std::vector<double> values_;
};

/// Reads a file of `times` snapshots of `nodes` nodes; element t holds x, y, z of every node at time t, not
/// finite where the run diverged. Throws lancet::Error when the file cannot be read or has another size.
[[nodiscard]] std::vector<std::vector<double>> read_snapshots(const std::filesystem::path& file, std::size_t times,
                                                              std::size_t nodes);

}  // namespace lancet::experiments::bar
