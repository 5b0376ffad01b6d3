#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lancet/experiments/bar/problem.hpp"
#include "lancet/experiments/bar/worker.hpp"

namespace lancet::experiments::bar {

/// Where the step matrix and the forces are evaluated.
enum class Linearisation {
    state,      ///< at x_n, as in the original
    prediction  ///< at x_n + dt v_n
};

/// The options of a baseline, beside those of the problem.
struct BaselineOptions {
    std::string scalar = "float";
    int threads = 1;
    int cg_iterations = 10;     ///< at most; exactly that many where cg_tolerance is 0
    double cg_tolerance = 0;    ///< on the residual norm relative to that of the right-hand side
    int rotation_interval = 1;  ///< rotations and matrix are updated every so many steps
    Linearisation linearisation = Linearisation::state;
    std::string preconditioner = "none";
    double newton_tolerance = 0;  ///< 0: one linear solve per step; else see EigenSolver
};

/// Iterations and the time of one step by part; the rest of the step is "rest".
struct StepCost {
    double seconds_forces = 0;
    double seconds_solve = 0;
    std::int64_t cg_iterations = 0;
    double solve_flops = 0;
    double solve_bytes = 0;
};

/// What the driver of the baselines needs of a solver.
class BaselineSolver {
  public:
    BaselineSolver() = default;
    BaselineSolver(const BaselineSolver&) = delete;
    BaselineSolver& operator=(const BaselineSolver&) = delete;
    virtual ~BaselineSolver() = default;

    /// One time step; `update` says whether rotations and matrix are computed anew.
    virtual StepCost step(bool update) = 0;
    /// x, y, z of every node.
    [[nodiscard]] virtual std::vector<double> positions() const = 0;
    [[nodiscard]] virtual std::vector<double> velocities() const = 0;
    /// Of its own arrays.
    [[nodiscard]] virtual std::int64_t bytes() const = 0;
};

/// How a baseline presents itself.
struct BaselineProgram {
    std::string method;
    std::string description;
    std::string operator_;
    std::vector<std::string> preconditioners;  ///< that it offers
    bool newton = false;                       ///< whether it offers --newton-tolerance
    std::unique_ptr<BaselineSolver> (*make_float)(const Problem&, const BaselineOptions&);
    std::unique_ptr<BaselineSolver> (*make_double)(const Problem&, const BaselineOptions&);
};

/// main() of a baseline: reads the command line, builds the problem, runs all steps, prints the report.
int run_baseline(int argc, const char* const* argv, const BaselineProgram& program);

/// Element numbers in groups whose members share no node, so that a group can be assembled in parallel: the numbers,
/// and where each group begins (with the end behind the last). One thread gets a single group in the mesh's own order.
struct ElementGroups {
    std::vector<std::int32_t> elements;
    std::vector<std::size_t> begins;
};
[[nodiscard]] ElementGroups group_elements(const mesh::TetMesh& mesh, int threads);

/// The block columns of a matrix row for every node, ascending: the nodes that share an element with it, and itself.
struct MatrixGraph {
    std::vector<std::size_t> begins;
    std::vector<std::int32_t> columns;
    /// Place of `column` in the row of `node`, from its begin. It must be there.
    [[nodiscard]] std::size_t place(std::int32_t node, std::int32_t column) const;
};
[[nodiscard]] MatrixGraph matrix_graph(const mesh::TetMesh& mesh);

/// Bytes of a vector's storage.
template <class Vector>
[[nodiscard]] std::int64_t storage(const Vector& vector) {
    return static_cast<std::int64_t>(vector.capacity() * sizeof(typename Vector::value_type));
}

}  // namespace lancet::experiments::bar
