#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "lancet/experiments/bar/corotational_element.hpp"
#include "lancet/experiments/bar/problem.hpp"

namespace lancet::experiments::precision {

/// What the baseline is asked for.
struct EigenStaticsOptions {
    bool corotational = true;
    std::string preconditioner = "diagonal";  ///< diagonal, incomplete-cholesky, or ldlt: the direct solver
    double tolerance = 1e-6;                  ///< of the residual, relative to the load
    std::array<double, 3> end_load{};         ///< N, spread over the face of largest x
    double longest_seconds = HUGE_VAL;        ///< of the processor: no Newton iteration begins later
    int threads = 1;                          ///< that share this time
};

/// How it went.
struct EigenStaticsReport {
    bool converged = false;
    bool gave_up = false;  ///< for it took too long
    double residual = 0;   ///< relative to the load
    std::int64_t iterations = 0;
    int newton_iterations = 0;
    double flops = 0;  ///< of the linear solves: products and vectors, or the factorisation
};

/// Static equilibrium as a competent user of Eigen finds it: the tangent in a row-major Eigen::SparseMatrix, its
/// pattern computed once and its values written in place; Newton's method with a line search on the potential energy;
/// Eigen::ConjugateGradient with one of Eigen's preconditioners, to a hundredth in each Newton step of the corotational
/// model, or Eigen::SimplicialLDLT. The linear model's matrix is assembled and factorised once.
template <class Scalar>
class EigenStatics {
  public:
    using Matrix = Eigen::SparseMatrix<Scalar, Eigen::RowMajor, int>;
    using Values = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
    using Vector = bar::Vector3<Scalar>;

    EigenStatics(const bar::Problem& problem, const EigenStaticsOptions& options) : options_(options) {
        const auto nodes = problem.mesh.nodes();
        unknown_.assign(nodes.size(), 0);
        for (const std::int32_t node : problem.fixed_nodes) unknown_[static_cast<std::size_t>(node)] = -1;
        for (int& unknown : unknown_) {
            if (unknown < 0) continue;
            unknown = unknowns_;
            unknowns_ += 3;
        }
        for (const mesh::Point& p : nodes) {
            rest_.push_back({static_cast<Scalar>(p[0]), static_cast<Scalar>(p[1]), static_cast<Scalar>(p[2])});
        }
        for (const mesh::Tetrahedron& tetrahedron : problem.mesh.tetrahedra()) {
            elements_.push_back(bar::make_element<Scalar>(problem, tetrahedron));
        }
        load_ = Values::Zero(unknowns_);
        add_gravity(problem);
        add_end_load(problem);
        build_pattern();
        make_solver();
    }

    EigenStaticsReport solve() {
        constexpr int most_newton_iterations = 200;
        EigenStaticsReport report;
        Values u = Values::Zero(unknowns_);
        const double load = load_.template cast<double>().norm();
        double energy = evaluate(u);
        const std::clock_t start = std::clock();
        while (true) {
            const double norm = residual_.template cast<double>().norm();
            report.residual = norm / load;
            report.converged = norm <= options_.tolerance * load;
            if (report.converged || report.newton_iterations == most_newton_iterations) break;
            const double busy = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / options_.threads;
            report.gave_up = busy > options_.longest_seconds;
            if (report.gave_up) break;
            if (options_.corotational || report.newton_iterations == 0) {
                assemble();
                factorise(report);
            }
            const double enough = options_.tolerance * load / norm;
            const Values d = solve_linear(options_.corotational ? std::max(1e-2, 0.5 * enough) : 0.5 * enough, report);
            ++report.newton_iterations;
            if (!search_line(u, d, energy, norm)) break;
        }
        displacement_ = u;
        return report;
    }

    /// x, y, z of every node.
    [[nodiscard]] std::vector<double> positions() const {
        std::vector<double> values;
        for (const Vector& p : moved(displacement_))
            values.insert(values.end(), {double(p.x), double(p.y), double(p.z)});
        return values;
    }

  private:
    template <class Preconditioner>
    using Iterative = Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper, Preconditioner>;
    using Direct = Eigen::SimplicialLDLT<Eigen::SparseMatrix<Scalar, Eigen::ColMajor, int>, Eigen::Lower>;

    void add_force(std::int32_t node, const std::array<double, 3>& force) {
        const int unknown = unknown_[static_cast<std::size_t>(node)];
        for (int axis = 0; unknown >= 0 && axis < 3; ++axis) {
            load_[unknown + axis] += static_cast<Scalar>(force[static_cast<std::size_t>(axis)]);
        }
    }

    void add_gravity(const bar::Problem& problem) {
        for (std::size_t element = 0; element < elements_.size(); ++element) {
            const double quarter = problem.density * problem.mesh.volume(static_cast<std::int32_t>(element)) / 4;
            std::array<double, 3> force{};
            for (std::size_t axis = 0; axis < 3; ++axis) force[axis] = quarter * problem.gravity[axis];
            for (const std::int32_t node : elements_[element].nodes) add_force(node, force);
        }
    }

    /// A third of each triangle's share of the force on each of its corners.
    void add_end_load(const bar::Problem& problem) {
        const auto nodes = problem.mesh.nodes();
        const auto bounds = problem.mesh.bounds();
        const double end = bounds[1][0] - 1e-9 * (bounds[1][0] - bounds[0][0]);
        struct Face {
            std::array<std::int32_t, 3> nodes;
            double area;
        };
        std::vector<Face> faces;
        double total = 0;
        for (const mesh::Tetrahedron& t : problem.mesh.tetrahedra()) {
            for (std::size_t opposite = 0; opposite < 4; ++opposite) {
                const std::array<std::int32_t, 3> corners{t[(opposite + 1) % 4], t[(opposite + 2) % 4],
                                                          t[(opposite + 3) % 4]};
                const auto at = [&](std::size_t i) { return nodes[static_cast<std::size_t>(corners[i])]; };
                if (at(0)[0] < end || at(1)[0] < end || at(2)[0] < end) continue;
                const double area = 0.5 * std::abs((at(1)[1] - at(0)[1]) * (at(2)[2] - at(0)[2]) -
                                                   (at(1)[2] - at(0)[2]) * (at(2)[1] - at(0)[1]));
                faces.push_back({corners, area});
                total += area;
            }
        }
        for (const Face& face : faces) {
            const double share = face.area / total / 3;
            for (const std::int32_t node : face.nodes) {
                add_force(node,
                          {share * options_.end_load[0], share * options_.end_load[1], share * options_.end_load[2]});
            }
        }
    }

    void build_pattern() {
        std::vector<Eigen::Triplet<Scalar, int>> entries;
        entries.reserve(144 * elements_.size());
        for (const auto& element : elements_) {
            for (const std::int32_t a : element.nodes) {
                for (const std::int32_t b : element.nodes) {
                    const int row = unknown_[static_cast<std::size_t>(a)],
                              column = unknown_[static_cast<std::size_t>(b)];
                    if (row < 0 || column < 0) continue;
                    for (int i = 0; i < 9; ++i) entries.emplace_back(row + i / 3, column + i % 3, Scalar(0));
                }
            }
        }
        matrix_.resize(unknowns_, unknowns_);
        matrix_.setFromTriplets(entries.begin(), entries.end());
        const int* const outer = matrix_.outerIndexPtr();
        const int* const inner = matrix_.innerIndexPtr();
        for (const auto& element : elements_) {
            std::array<int, 16>& places = places_.emplace_back();
            for (std::size_t i = 0; i < 16; ++i) {
                const int row = unknown_[static_cast<std::size_t>(element.nodes[i / 4])];
                const int column = unknown_[static_cast<std::size_t>(element.nodes[i % 4])];
                places[i] = -1;
                if (row < 0 || column < 0) continue;
                places[i] =
                    static_cast<int>(std::lower_bound(inner + outer[row], inner + outer[row + 1], column) - inner);
            }
        }
    }

    void make_solver() {
        if (options_.preconditioner == "ldlt") {
            solver_.template emplace<Direct>();
        } else if (options_.preconditioner == "incomplete-cholesky") {
            solver_.template emplace<Iterative<Eigen::IncompleteCholesky<Scalar>>>();
        } else {
            solver_.template emplace<Iterative<Eigen::DiagonalPreconditioner<Scalar>>>();
        }
        std::visit([this](auto& solver) { solver.analyzePattern(matrix_); }, solver_);
    }

    [[nodiscard]] std::vector<Vector> moved(const Values& u) const {
        std::vector<Vector> x = rest_;
        for (std::size_t node = 0; node < x.size(); ++node) {
            const int unknown = unknown_[node];
            if (unknown >= 0) x[node] = x[node] + Vector{u[unknown], u[unknown + 1], u[unknown + 2]};
        }
        return x;
    }

    /// Rotations, residual and potential energy at a displacement; returns the energy.
    double evaluate(const Values& u) {
        const std::vector<Vector> x = moved(u);
        residual_ = load_;
        double energy = -load_.template cast<double>().dot(u.template cast<double>());
        for (auto& element : elements_) {
            if (options_.corotational) element.rotate(x);
            const std::array<Vector, 4> f = element.forces(x);
            const Vector origin = x[static_cast<std::size_t>(element.nodes[0])];
            for (std::size_t j = 0; j < 4; ++j) {
                const auto node = static_cast<std::size_t>(element.nodes[j]);
                if (j > 0) {
                    const Vector stretch = x[node] - origin - element.rotation * element.rest_edges[j - 1];
                    energy -= 0.5 * static_cast<double>(dot(f[j], stretch));
                }
                const int unknown = unknown_[node];
                if (unknown < 0) continue;
                residual_[unknown] += f[j].x;
                residual_[unknown + 1] += f[j].y;
                residual_[unknown + 2] += f[j].z;
            }
        }
        return energy;
    }

    /// R K R^T with the rotations of the last evaluation.
    void assemble() {
        Scalar* const values = matrix_.valuePtr();
        std::fill_n(values, matrix_.nonZeros(), Scalar(0));
        const int* const outer = matrix_.outerIndexPtr();
        for (std::size_t index = 0; index < elements_.size(); ++index) {
            const auto blocks = elements_[index].rotated_stiffness(Scalar(1));
            for (std::size_t i = 0; i < 16; ++i) {
                if (places_[index][i] < 0) continue;
                const int row = unknown_[static_cast<std::size_t>(elements_[index].nodes[i / 4])];
                const int stride = outer[row + 1] - outer[row];
                Scalar* target = values + places_[index][i];
                const Scalar* block = blocks[i].m.data();
                for (int axis = 0; axis < 3; ++axis, target += stride, block += 3) {
                    target[0] += block[0];
                    target[1] += block[1];
                    target[2] += block[2];
                }
            }
        }
    }

    void factorise(EigenStaticsReport& report) {
        std::visit([this](auto& solver) { solver.factorize(matrix_); }, solver_);
        const auto* direct = std::get_if<Direct>(&solver_);
        if (direct == nullptr) return;
        // Of an LDL^T: the squares of the lengths of L's columns.
        for (int column = 0; column < unknowns_; ++column)
            report.flops += length(*direct, column) * length(*direct, column);
    }

    /// Of a column of L.
    static double length(const Direct& solver, int column) {
        const auto& factor = solver.matrixL().nestedExpression();
        return factor.outerIndexPtr()[column + 1] - factor.outerIndexPtr()[column];
    }

    Values solve_linear(double tolerance, EigenStaticsReport& report) {
        const auto entries = static_cast<double>(matrix_.nonZeros());
        return std::visit(
            [&](auto& solver) -> Values {
                if constexpr (std::is_same_v<std::decay_t<decltype(solver)>, Direct>) {
                    // Two products with L.
                    for (int column = 0; column < unknowns_; ++column) report.flops += 4 * length(solver, column);
                    ++report.iterations;
                    return solver.solve(residual_);
                } else {
                    solver.setTolerance(static_cast<Scalar>(tolerance));
                    solver.setMaxIterations(20'000);
                    Values d = solver.solve(residual_);
                    report.iterations += solver.iterations();
                    report.flops += static_cast<double>(solver.iterations()) * (2 * entries + 10.0 * unknowns_);
                    return d;
                }
            },
            solver_);
    }

    /// Halves the step until the energy has fallen enough (Armijo 1966), or, where rounding hides that, the residual
    /// has.
    bool search_line(Values& u, const Values& d, double& energy, double norm) {
        const double slope = residual_.template cast<double>().dot(d.template cast<double>());
        if (!(slope > 0)) return false;
        const double scale = std::abs(energy) + std::abs(load_.template cast<double>().dot(u.template cast<double>()));
        const double rounding = (sizeof(Scalar) == 4 ? 1e-5 : 1e-13) * scale;
        double length = 1;
        for (int halving = 0; halving < 30; ++halving, length /= 2) {
            const Values trial = u + static_cast<Scalar>(length) * d;
            const double reached = evaluate(trial);
            const bool descends = slope * length > 16 * rounding ? reached <= energy - 1e-4 * length * slope + rounding
                                                                 : residual_.template cast<double>().norm() < norm;
            if (!descends) continue;
            u = trial;
            energy = reached;
            return true;
        }
        energy = evaluate(u);
        return false;
    }

    EigenStaticsOptions options_;
    int unknowns_ = 0;
    std::vector<int> unknown_;  ///< first unknown of a node, negative when it is fixed
    std::vector<Vector> rest_;
    std::vector<bar::CorotationalElement<Scalar>> elements_;
    std::vector<std::array<int, 16>> places_;  ///< of entry (0, 0) of each block among the matrix's values
    Values load_, residual_, displacement_;
    Matrix matrix_;
    std::variant<Iterative<Eigen::DiagonalPreconditioner<Scalar>>, Iterative<Eigen::IncompleteCholesky<Scalar>>, Direct>
        solver_;
};

}  // namespace lancet::experiments::precision
