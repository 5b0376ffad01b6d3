#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::experiments::precision {

using mesh::Point;

/// How a problem is solved, in the words of a row; empty and zero where a word does not apply.
struct Setting {
    std::string method = "lancet";  ///< lancet, lancet-extrapolated (from two meshes) or eigen
    std::string series;             ///< in the diagram
    std::string operator_;          ///< "operator" in files
    std::string scalar;
    std::string preconditioner;
    std::string integrator;
    std::string linearisation;
    std::string tangent;
    std::string rotation;
    int rotation_interval = 0;
    std::array<int, 3> cells{};
    double time_step = 0;         ///< s
    double tolerance = 0;         ///< statics: of the residual; dynamics: of each linear solve
    int iterations = 0;           ///< most of each linear solve
    double newton_tolerance = 0;  ///< of each step; 0: linearised once
    std::string scheduler = "serial";
    int threads = 1;
    std::string instruction_set;

    /// For progress and messages.
    [[nodiscard]] std::string label() const;
};

/// What a run came to.
struct Solution {
    std::vector<Point> positions;       ///< in the mesh's order, m
    std::array<int, 3> cells{};         ///< of the mesh that the positions are on, where it is not the setting's
    double seconds = 0;                 ///< wall clock, of all that is needed from the mesh on (dynamics: of all steps)
    double flops = 0;                   ///< of the linear solves, from the formulas of their kernels
    std::optional<std::int64_t> bytes;  ///< of the solver, at most
    std::int64_t iterations = 0;        ///< of all linear solves
    std::optional<double> drift_energy, drift_momentum;  ///< largest relative change of what should be kept
    std::string outcome = "converged";                   ///< or what is to be said of it
};

/// A run that came to nothing: its kind (diverged, inaccurate, stagnated, lost stability, refused, too slow,
/// not offered), and how.
class RunFailed : public std::runtime_error {
  public:
    RunFailed(std::string kind, const std::string& explanation)
        : std::runtime_error(explanation), kind_(std::move(kind)) {}
    [[nodiscard]] const std::string& kind() const { return kind_; }

  private:
    std::string kind_;
};

/// A run to measure.
struct Case {
    Setting setting;
    std::size_t elements = 0;
    std::string family;       ///< cases that differ in the size of the mesh alone have the same one
    double growth = 4.0 / 3;  ///< how the time of a family grows with the elements, as a power
    std::function<Solution()> run;
};

/// Errors in percent; what has no reference is missing.
struct Errors {
    std::optional<double> l2, energy, quantity;
    double value = 0;  ///< of the quantity of interest

    /// What a run is judged by: the larger of the errors in the L2 norm and the quantity of interest, so that no lucky
    /// crossing of a single number passes for accuracy.
    [[nodiscard]] double judged() const;
};

/// A measured run.
struct Row {
    std::string problem, variant;
    Setting setting;
    std::size_t elements = 0;
    double seconds = 0, seconds_minimum = 0, seconds_maximum = 0;  ///< median and range
    int repetitions = 0;
    Solution solution;  ///< without the positions
    Errors errors;
    bool pareto = false;
};

/// A run that is not among the rows, or is there with a reservation.
struct Omission {
    std::string problem, variant;
    Setting setting;
    std::string kind;
    std::string explanation;
};

/// Everything measured.
struct Results {
    std::vector<Row> rows;
    std::vector<Omission> omissions;
};

}  // namespace lancet::experiments::precision
