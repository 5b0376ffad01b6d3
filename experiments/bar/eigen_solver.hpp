#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include "lancet/experiments/bar/baseline.hpp"
#include "lancet/experiments/bar/corotational_element.hpp"
#include "lancet/experiments/bar/energy.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/runtime/observe/clock.hpp"

namespace lancet::experiments::bar {

/// Corotational tetrahedra as a competent user of Eigen writes them: the step matrix without the fixed nodes in a
/// row-major Eigen::SparseMatrix, its pattern computed once and its values written in place; rotations by Higham's
/// iteration; Eigen::ConjugateGradient with one of Eigen's preconditioners: none, diagonal, incomplete-cholesky.
///
/// With newton_tolerance t the step is solved to |g| <= t |dt M g_gravity|, g the residual of implicit Euler
/// M (v - v_n) = dt (f_int(x_n + dt v) + f_ext - D v), by repeating the linear solve at the new prediction; the first
/// one is the ordinary step. Throws lancet::Error where that does not converge.
template <class Scalar>
class EigenSolver final : public BaselineSolver {
  public:
    using Matrix = Eigen::SparseMatrix<Scalar, Eigen::RowMajor, int>;
    using Values = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
    using Vector = Vector3<Scalar>;

    EigenSolver(const Problem& problem, const BaselineOptions& options)
        : options_(options),
          time_step_(static_cast<Scalar>(problem.time_step)),
          damping_mass_(static_cast<Scalar>(problem.rayleigh_mass)),
          damping_stiffness_(static_cast<Scalar>(problem.rayleigh_stiffness)),
          groups_(group_elements(problem.mesh, options.threads)) {
        Eigen::setNbThreads(options.threads);
        number_unknowns(problem);
        for (const mesh::Point& p : problem.mesh.nodes()) {
            positions_.push_back({static_cast<Scalar>(p[0]), static_cast<Scalar>(p[1]), static_cast<Scalar>(p[2])});
        }
        masses_.resize(unknowns_);
        load_.resize(unknowns_);
        const std::vector<double> masses = lumped_masses(problem);
        for (std::size_t node = 0; node < masses.size(); ++node) {
            if (unknown_[node] < 0) continue;
            for (int axis = 0; axis < 3; ++axis) {
                masses_[unknown_[node] + axis] = static_cast<Scalar>(masses[node]);
                load_[unknown_[node] + axis] =
                    static_cast<Scalar>(masses[node] * problem.gravity[static_cast<std::size_t>(axis)]);
            }
        }
        velocities_ = Values::Zero(unknowns_);
        forces_ = Values::Zero(unknowns_);
        change_ = Values::Zero(unknowns_);
        right_hand_side_ = Values::Zero(unknowns_);
        build_pattern(problem.mesh);
        for (const mesh::Tetrahedron& tetrahedron : problem.mesh.tetrahedra()) {
            elements_.push_back(make_element<Scalar>(problem, tetrahedron));
        }
        make_solver();
    }

    StepCost step(bool update) override {
        return options_.linearisation == Linearisation::state ? step_at_state(update) : step_at_prediction(update);
    }

    /// Rotations at `x`, and the step matrix (1 + dt alpha) M + (dt beta + dt^2) K with them.
    void assemble(const std::vector<Vector>& x) {
        const Scalar stiffness_factor = time_step_ * damping_stiffness_ + time_step_ * time_step_;
        const Scalar mass_factor = 1 + time_step_ * damping_mass_;
        Scalar* const values = matrix_.valuePtr();
        std::fill_n(values, matrix_.nonZeros(), Scalar(0));
        for (int row = 0; row < unknowns_; ++row) values[diagonal_[row]] = mass_factor * masses_[row];
        for_each_element([&](std::int32_t index) {
            CorotationalElement<Scalar>& element = elements_[index];
            element.rotate(x);
            const ElementBlocks<Scalar> blocks = element.rotated_stiffness(stiffness_factor);
            const ElementPlaces& places = places_[index];
            for (std::size_t i = 0; i < 4; ++i) {
                const std::int32_t stride = places.row_length[i];
                for (std::size_t j = 0; j < 4; ++j) {
                    if (places.first[4 * i + j] < 0) continue;
                    Scalar* row = values + places.first[4 * i + j];
                    const Scalar* block = blocks[4 * i + j].m.data();
                    for (int axis = 0; axis < 3; ++axis, row += stride, block += 3) {
                        row[0] += block[0];
                        row[1] += block[1];
                        row[2] += block[2];
                    }
                }
            }
        });
    }

    /// Elastic forces at `x` on the nodes that move, with the rotations of the last assemble().
    void elastic_forces(const std::vector<Vector>& x) {
        forces_.setZero();
        for_each_element([&](std::int32_t index) {
            const CorotationalElement<Scalar>& element = elements_[index];
            const std::array<Vector, 4> f = element.forces(x);
            for (std::size_t i = 0; i < 4; ++i) {
                const int unknown = unknown_[element.nodes[i]];
                if (unknown < 0) continue;
                Scalar* const sum = forces_.data() + unknown;
                sum[0] += f[i].x;
                sum[1] += f[i].y;
                sum[2] += f[i].z;
            }
        });
    }

    [[nodiscard]] std::vector<double> positions() const override {
        std::vector<double> values;
        values.reserve(3 * positions_.size());
        for (const Vector& v : positions_) values.insert(values.end(), {double(v.x), double(v.y), double(v.z)});
        return values;
    }

    [[nodiscard]] std::vector<double> velocities() const override {
        std::vector<double> values(3 * positions_.size(), 0.0);
        for (std::size_t node = 0; node < positions_.size(); ++node) {
            for (int axis = 0; unknown_[node] >= 0 && axis < 3; ++axis) {
                values[3 * node + static_cast<std::size_t>(axis)] = double(velocities_[unknown_[node] + axis]);
            }
        }
        return values;
    }

    [[nodiscard]] std::int64_t bytes() const override {
        const std::int64_t vector = std::int64_t(sizeof(Scalar)) * unknowns_;
        const std::int64_t entry = sizeof(Scalar) + sizeof(int);
        const std::int64_t matrix = entry * matrix_.nonZeros() + std::int64_t(sizeof(int)) * unknowns_;
        std::int64_t sum = matrix + 10 * vector;  // six of ours, four inside of the conjugate gradients
        if (options_.preconditioner == "diagonal") sum += vector;
        if (options_.preconditioner == "incomplete-cholesky") sum += matrix / 2;
        return sum + storage(elements_) + storage(places_) + storage(positions_) + storage(predicted_) +
               storage(unknown_) + storage(diagonal_) + storage(groups_.elements);
    }

  private:
    /// Where the blocks of an element are in the values of the matrix.
    struct ElementPlaces {
        std::array<std::int32_t, 16> first;      ///< entry (0, 0) of the block, negative when a node is fixed
        std::array<std::int32_t, 4> row_length;  ///< from one row of the block to the next
    };

    template <class Preconditioner>
    using Solver = Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper, Preconditioner>;

    template <class Function>
    void for_each_element(const Function& function) {
#pragma omp parallel num_threads(options_.threads) if (options_.threads > 1)
        for (std::size_t group = 0; group + 1 < groups_.begins.size(); ++group) {
            const auto first = static_cast<std::ptrdiff_t>(groups_.begins[group]);
            const auto last = static_cast<std::ptrdiff_t>(groups_.begins[group + 1]);
#pragma omp for
            for (std::ptrdiff_t i = first; i < last; ++i) function(groups_.elements[static_cast<std::size_t>(i)]);
        }
    }

    void number_unknowns(const Problem& problem) {
        unknown_.assign(problem.mesh.nodes().size(), 0);
        for (const std::int32_t node : problem.fixed_nodes) unknown_[node] = -1;
        unknowns_ = 0;
        for (int& unknown : unknown_) {
            if (unknown < 0) continue;
            unknown = unknowns_;
            unknowns_ += 3;
        }
    }

    void build_pattern(const mesh::TetMesh& mesh) {
        const MatrixGraph graph = matrix_graph(mesh);
        matrix_.resize(unknowns_, unknowns_);
        Eigen::VectorXi row_sizes(unknowns_);
        std::vector<std::vector<int>> columns(unknown_.size());  // first unknowns of the moving neighbours
        for (std::size_t node = 0; node < unknown_.size(); ++node) {
            if (unknown_[node] < 0) continue;
            for (std::size_t k = graph.begins[node]; k < graph.begins[node + 1]; ++k) {
                if (unknown_[graph.columns[k]] >= 0) columns[node].push_back(unknown_[graph.columns[k]]);
            }
            for (int axis = 0; axis < 3; ++axis) {
                row_sizes[unknown_[node] + axis] = static_cast<int>(3 * columns[node].size());
            }
        }
        matrix_.reserve(row_sizes);
        diagonal_.resize(static_cast<std::size_t>(unknowns_));
        for (std::size_t node = 0; node < unknown_.size(); ++node) {
            for (int axis = 0; unknown_[node] >= 0 && axis < 3; ++axis) {
                for (const int column : columns[node]) {
                    for (int other = 0; other < 3; ++other) {
                        matrix_.insert(unknown_[node] + axis, column + other) = Scalar(1);
                    }
                }
            }
        }
        matrix_.makeCompressed();
        const auto place = [&](int row, std::size_t node, int column) {
            const auto& list = columns[node];
            const auto found = std::lower_bound(list.begin(), list.end(), column) - list.begin();
            return matrix_.outerIndexPtr()[row] + 3 * static_cast<int>(found);
        };
        for (std::size_t node = 0; node < unknown_.size(); ++node) {
            for (int axis = 0; unknown_[node] >= 0 && axis < 3; ++axis) {
                const int row = unknown_[node] + axis;
                diagonal_[static_cast<std::size_t>(row)] = place(row, node, unknown_[node]) + axis;
            }
        }
        for (const mesh::Tetrahedron& nodes : mesh.tetrahedra()) {
            ElementPlaces places{};
            places.first.fill(-1);
            for (std::size_t i = 0; i < 4; ++i) {
                const auto row_node = static_cast<std::size_t>(nodes[i]);
                places.row_length[i] = static_cast<std::int32_t>(3 * columns[row_node].size());
                for (std::size_t j = 0; j < 4; ++j) {
                    if (unknown_[row_node] < 0 || unknown_[nodes[j]] < 0) continue;
                    places.first[4 * i + j] = place(unknown_[row_node], row_node, unknown_[nodes[j]]);
                }
            }
            places_.push_back(places);
        }
    }

    void make_solver() {
        if (options_.preconditioner == "diagonal") {
            solver_.template emplace<Solver<Eigen::DiagonalPreconditioner<Scalar>>>();
        } else if (options_.preconditioner == "incomplete-cholesky") {
            solver_.template emplace<Solver<Eigen::IncompleteCholesky<Scalar>>>();
        } else {
            solver_.template emplace<Solver<Eigen::IdentityPreconditioner>>();
        }
        std::visit(
            [this](auto& solver) {
                solver.setMaxIterations(options_.cg_iterations);
                solver.setTolerance(static_cast<Scalar>(options_.cg_tolerance));
                solver.analyzePattern(matrix_);
            },
            solver_);
    }

    /// change_ <- A^-1 right_hand_side_, starting from `guess` (or zero).
    void solve(const Values* guess, bool matrix_changed, StepCost& cost) {
        std::visit(
            [&](auto& solver) {
                if (matrix_changed) solver.factorize(matrix_);
                if (guess != nullptr) {
                    change_ = solver.solveWithGuess(right_hand_side_, *guess);
                } else {
                    change_ = solver.solve(right_hand_side_);
                }
                const auto iterations =
                    std::min<std::int64_t>(solver.iterations() + 1, options_.cg_iterations);  // Eigen counts from 0
                cost.cg_iterations += iterations;
                const double products = static_cast<double>(iterations + 1);  // one for the first residual
                const auto entries = static_cast<double>(matrix_.nonZeros());
                cost.solve_flops += products * 2 * entries + static_cast<double>(iterations) * 10 * unknowns_;
                cost.solve_bytes +=
                    products * (entries * (sizeof(Scalar) + sizeof(int)) + double(unknowns_) * sizeof(int)) +
                    static_cast<double>(iterations) * 15 * unknowns_ * sizeof(Scalar);
            },
            solver_);
    }

    /// Linearised at x_n: A v_{n+1} = M v_n + dt (f_int + f_ext), which is (M + dt D + dt^2 K) dv = dt (f_int + f_ext -
    /// D v_n - dt K v_n) with v_n as the first guess.
    StepCost step_at_state(bool update) {
        StepCost cost;
        const double begin = runtime::steady_seconds();
        if (update) assemble(positions_);
        elastic_forces(positions_);
        cost.seconds_forces = runtime::steady_seconds() - begin;

        right_hand_side_ = masses_.cwiseProduct(velocities_) + time_step_ * (forces_ + load_);
        const double solve_begin = runtime::steady_seconds();
        solve(&velocities_, update, cost);
        cost.seconds_solve = runtime::steady_seconds() - solve_begin;
        velocities_.swap(change_);
        advance(positions_, velocities_);
        return cost;
    }

    /// Linearised at the prediction, once or until the step is solved.
    StepCost step_at_prediction(bool update) {
        constexpr int most_solves = 100;
        StepCost cost;
        const bool newton = options_.newton_tolerance > 0;
        const Scalar stiffness_share =
            damping_stiffness_ / (time_step_ * damping_stiffness_ + time_step_ * time_step_) * time_step_;
        const Scalar mass_factor = 1 + time_step_ * damping_mass_;
        const Values before = newton ? velocities_ : Values();
        for (int solves = 0;; ++solves) {
            predicted_ = positions_;
            advance(predicted_, velocities_);
            const double begin = runtime::steady_seconds();
            if (update) assemble(predicted_);
            elastic_forces(predicted_);
            cost.seconds_forces += runtime::steady_seconds() - begin;

            right_hand_side_ = time_step_ * (forces_ + load_ - damping_mass_ * masses_.cwiseProduct(velocities_));
            if (stiffness_share > 0) {
                right_hand_side_ -=
                    stiffness_share * (matrix_ * velocities_ - mass_factor * masses_.cwiseProduct(velocities_));
            }
            if (newton) {
                right_hand_side_ -= masses_.cwiseProduct(velocities_ - before);
                if (right_hand_side_.norm() <= Scalar(options_.newton_tolerance) * time_step_ * load_.norm()) break;
            }
            const double solve_begin = runtime::steady_seconds();
            solve(nullptr, update, cost);
            cost.seconds_solve += runtime::steady_seconds() - solve_begin;
            velocities_ += change_;
            if (!newton) break;
            if (solves == most_solves || !velocities_.allFinite()) {
                throw Error("--newton-tolerance: a step is not solved after " + std::to_string(solves + 1) +
                            " linear solves, expected convergence; try a shorter time step");
            }
        }
        advance(positions_, velocities_);
        return cost;
    }

    /// x <- x + dt v
    void advance(std::vector<Vector>& x, const Values& v) const {
        for (std::size_t node = 0; node < x.size(); ++node) {
            const int unknown = unknown_[node];
            if (unknown < 0) continue;
            x[node] = x[node] + time_step_ * Vector{v[unknown], v[unknown + 1], v[unknown + 2]};
        }
    }

    BaselineOptions options_;
    Scalar time_step_;
    Scalar damping_mass_;
    Scalar damping_stiffness_;
    ElementGroups groups_;
    int unknowns_ = 0;
    std::vector<int> unknown_;  ///< first unknown of a node, negative when it is fixed
    std::vector<CorotationalElement<Scalar>> elements_;
    std::vector<ElementPlaces> places_;
    std::vector<int> diagonal_;
    std::vector<Vector> positions_, predicted_;
    Values masses_, load_, velocities_, forces_, change_, right_hand_side_;
    Matrix matrix_;
    std::variant<Solver<Eigen::IdentityPreconditioner>, Solver<Eigen::DiagonalPreconditioner<Scalar>>,
                 Solver<Eigen::IncompleteCholesky<Scalar>>>
        solver_;
};

}  // namespace lancet::experiments::bar
