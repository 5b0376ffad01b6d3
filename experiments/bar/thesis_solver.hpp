#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <omp.h>

#include "lancet/experiments/bar/baseline.hpp"
#include "lancet/experiments/bar/corotational_element.hpp"
#include "lancet/experiments/bar/energy.hpp"
#include "lancet/runtime/observe/clock.hpp"

namespace lancet::experiments::bar {

/// Corotational tetrahedra as in L. Jerabkova, Interactive Cutting of Finite Elements based Deformable Objects in
/// Virtual Environments (RWTH Aachen 2007): arrays of structures, scalar arithmetic, OpenMP loops. Forces go to a
/// private vector per thread and are merged afterwards (her figures 5.5 to 5.7); the step matrix is a list of 3 x 3
/// blocks for every node; conjugate gradients with filtered constraints are written out by hand.
template <class Scalar>
class ThesisSolver final : public BaselineSolver {
  public:
    using Vector = Vector3<Scalar>;

    ThesisSolver(const Problem& problem, const BaselineOptions& options)
        : options_(options),
          time_step_(static_cast<Scalar>(problem.time_step)),
          damping_mass_(static_cast<Scalar>(problem.rayleigh_mass)),
          damping_stiffness_(static_cast<Scalar>(problem.rayleigh_stiffness)),
          gravity_{static_cast<Scalar>(problem.gravity[0]), static_cast<Scalar>(problem.gravity[1]),
                   static_cast<Scalar>(problem.gravity[2])},
          groups_(group_elements(problem.mesh, options.threads)) {
        const std::size_t nodes = problem.mesh.nodes().size();
        for (const mesh::Point& p : problem.mesh.nodes()) {
            positions_.push_back({static_cast<Scalar>(p[0]), static_cast<Scalar>(p[1]), static_cast<Scalar>(p[2])});
        }
        for (const double mass : lumped_masses(problem)) masses_.push_back(static_cast<Scalar>(mass));
        fixed_.assign(nodes, 0);
        for (const std::int32_t node : problem.fixed_nodes) fixed_[node] = 1;
        for (std::vector<Vector>* vector :
             {&velocities_, &forces_, &change_, &residual_, &direction_, &image_, &predicted_}) {
            vector->assign(nodes, Vector{});
        }
        private_forces_.assign(static_cast<std::size_t>(options.threads), std::vector<Vector>(nodes));
        build_matrix(problem.mesh);
        for (const mesh::Tetrahedron& tetrahedron : problem.mesh.tetrahedra()) {
            elements_.push_back({make_element<Scalar>(problem, tetrahedron), {}});
            auto& element = elements_.back();
            for (std::size_t i = 0; i < 4; ++i) {
                for (std::size_t j = 0; j < 4; ++j) {
                    const auto row = static_cast<std::size_t>(tetrahedron[i]);
                    element.entries[4 * i + j] =
                        static_cast<std::int32_t>(rows_[row] + graph_.place(tetrahedron[i], tetrahedron[j]));
                }
            }
        }
    }

    StepCost step(bool update) override {
        StepCost cost;
        const bool prediction = options_.linearisation == Linearisation::prediction;
        const std::size_t nodes = positions_.size();
        if (prediction) {
            for (std::size_t node = 0; node < nodes; ++node) {
                predicted_[node] = positions_[node] + time_step_ * velocities_[node];
            }
        }
        const std::vector<Vector>& where = prediction ? predicted_ : positions_;
        const double begin = runtime::steady_seconds();
        if (update) assemble(where);
        elastic_forces(where, forces_);
        cost.seconds_forces = runtime::steady_seconds() - begin;

        right_hand_side(prediction);
        const double solve_begin = runtime::steady_seconds();
        solve(cost);
        cost.seconds_solve = runtime::steady_seconds() - solve_begin;

        for (std::size_t node = 0; node < nodes; ++node) {
            velocities_[node] = velocities_[node] + change_[node];
            positions_[node] = prediction ? predicted_[node] + time_step_ * change_[node]
                                          : positions_[node] + time_step_ * velocities_[node];
        }
        return cost;
    }

    /// Rotations at `x`, and the step matrix (1 + dt alpha) M + (dt beta + dt^2) K with them.
    void assemble(const std::vector<Vector>& x) {
        const Scalar stiffness_factor = time_step_ * damping_stiffness_ + time_step_ * time_step_;
        const Scalar mass_factor = 1 + time_step_ * damping_mass_;
        const auto nodes = static_cast<std::ptrdiff_t>(rows_.size()) - 1;
#pragma omp parallel num_threads(options_.threads) if (options_.threads > 1)
        {
#pragma omp for
            for (std::ptrdiff_t node = 0; node < nodes; ++node) {
                for (std::size_t entry = rows_[node]; entry < rows_[node + 1]; ++entry) {
                    const Scalar diagonal = matrix_[entry].column == node ? mass_factor * masses_[node] : Scalar(0);
                    matrix_[entry].block = {{diagonal, 0, 0, 0, diagonal, 0, 0, 0, diagonal}};
                }
            }
            for (std::size_t group = 0; group + 1 < groups_.begins.size(); ++group) {
                const auto first = static_cast<std::ptrdiff_t>(groups_.begins[group]);
                const auto last = static_cast<std::ptrdiff_t>(groups_.begins[group + 1]);
#pragma omp for
                for (std::ptrdiff_t i = first; i < last; ++i) {
                    MappedElement& mapped = elements_[groups_.elements[i]];
                    mapped.element.rotate(x);
                    const ElementBlocks<Scalar> blocks = mapped.element.rotated_stiffness(stiffness_factor);
                    for (std::size_t pair = 0; pair < 16; ++pair) {
                        Matrix3<Scalar>& sum = matrix_[mapped.entries[pair]].block;
                        for (std::size_t entry = 0; entry < 9; ++entry) sum.m[entry] += blocks[pair].m[entry];
                    }
                }
            }
        }
    }

    /// Elastic forces at `x` with the rotations of the last assemble(), constraints not applied.
    void elastic_forces(const std::vector<Vector>& x, std::vector<Vector>& forces) {
        const auto nodes = static_cast<std::ptrdiff_t>(x.size());
        const auto elements = static_cast<std::ptrdiff_t>(elements_.size());
#pragma omp parallel num_threads(options_.threads) if (options_.threads > 1)
        {
            std::vector<Vector>& own = private_forces_[static_cast<std::size_t>(omp_get_thread_num())];
            for (Vector& force : own) force = Vector{};
#pragma omp for schedule(static)
            for (std::ptrdiff_t i = 0; i < elements; ++i) {
                const CorotationalElement<Scalar>& element = elements_[i].element;
                const std::array<Vector, 4> f = element.forces(x);
                for (std::size_t node = 0; node < 4; ++node) {
                    own[element.nodes[node]] = own[element.nodes[node]] + f[node];
                }
            }
            const std::size_t team = static_cast<std::size_t>(omp_get_num_threads());
#pragma omp for schedule(static)
            for (std::ptrdiff_t node = 0; node < nodes; ++node) {
                Vector sum = private_forces_[0][node];
                for (std::size_t thread = 1; thread < team; ++thread) sum = sum + private_forces_[thread][node];
                forces[node] = sum;
            }
        }
    }

    [[nodiscard]] std::vector<double> positions() const override {
        return flat(positions_);
    }
    [[nodiscard]] std::vector<double> velocities() const override {
        return flat(velocities_);
    }

    [[nodiscard]] std::int64_t bytes() const override {
        std::int64_t sum = storage(elements_) + storage(matrix_) + storage(rows_) + storage(masses_) + storage(fixed_) +
                           storage(groups_.elements) + storage(graph_.begins) + storage(graph_.columns);
        for (const auto* vector :
             {&positions_, &velocities_, &forces_, &change_, &residual_, &direction_, &image_, &predicted_}) {
            sum += storage(*vector);
        }
        for (const auto& vector : private_forces_) sum += storage(vector);
        return sum;
    }

  private:
    struct MappedElement {
        CorotationalElement<Scalar> element;
        std::array<std::int32_t, 16> entries;  ///< where its blocks are in the matrix
    };
    struct Entry {
        Matrix3<Scalar> block;
        std::int32_t column;
    };

    void build_matrix(const mesh::TetMesh& mesh) {
        graph_ = matrix_graph(mesh);
        rows_ = graph_.begins;
        matrix_.reserve(graph_.columns.size());
        for (const std::int32_t column : graph_.columns) matrix_.push_back({{}, column});
    }

    /// residual <- dt (f_int + f_ext - D v [- dt K v]), filtered. K v comes from the product with the step matrix:
    /// (dt beta + dt^2) K v = A v - (1 + dt alpha) M v.
    void right_hand_side(bool prediction) {
        const auto nodes = static_cast<std::ptrdiff_t>(positions_.size());
        const Scalar mass_factor = 1 + time_step_ * damping_mass_;
        const Scalar stiffness_factor = time_step_ * damping_stiffness_ + time_step_ * time_step_;
        // Of A v - (1 + dt alpha) M v, what the right-hand side takes.
        const Scalar share = prediction ? time_step_ * damping_stiffness_ / stiffness_factor : Scalar(1);
        const bool with_stiffness = share > 0;
        if (with_stiffness) multiply(velocities_, image_);
#pragma omp parallel for num_threads(options_.threads) if (options_.threads > 1)
        for (std::ptrdiff_t node = 0; node < nodes; ++node) {
            const Scalar mass = masses_[node];
            const Vector& v = velocities_[node];
            Vector r = time_step_ * (forces_[node] + mass * gravity_ - (damping_mass_ * mass) * v);
            if (with_stiffness) r = r - share * (image_[node] - (mass_factor * mass) * v);
            residual_[node] = fixed_[node] ? Vector{} : r;
        }
    }

    /// y = A x; rows of fixed nodes are zero.
    void multiply(const std::vector<Vector>& x, std::vector<Vector>& y) const {
        const auto nodes = static_cast<std::ptrdiff_t>(x.size());
#pragma omp parallel for num_threads(options_.threads) if (options_.threads > 1)
        for (std::ptrdiff_t node = 0; node < nodes; ++node) {
            Vector sum{};
            if (!fixed_[node]) {
                const Entry* const end = matrix_.data() + rows_[node + 1];
                for (const Entry* entry = matrix_.data() + rows_[node]; entry != end; ++entry) {
                    sum = sum + entry->block * x[entry->column];
                }
            }
            y[node] = sum;
        }
    }

    [[nodiscard]] Scalar inner_product(const std::vector<Vector>& a, const std::vector<Vector>& b) const {
        const auto nodes = static_cast<std::ptrdiff_t>(a.size());
        Scalar sum = 0;
#pragma omp parallel for simd reduction(+ : sum) num_threads(options_.threads) if (parallel : options_.threads > 1)
        for (std::ptrdiff_t node = 0; node < nodes; ++node) sum += dot(a[node], b[node]);
        return sum;
    }

    /// Conjugate gradients for the velocity change, from zero; the right-hand side is in residual_.
    void solve(StepCost& cost) {
        const auto nodes = static_cast<std::ptrdiff_t>(positions_.size());
        for (Vector& value : change_) value = Vector{};
        direction_ = residual_;
        Scalar norm = inner_product(residual_, residual_);
        const auto tolerance = static_cast<Scalar>(options_.cg_tolerance);
        const Scalar enough = tolerance * tolerance * norm;
        int iteration = 0;
        while (iteration < options_.cg_iterations && norm > enough) {
            multiply(direction_, image_);
            const Scalar curvature = inner_product(direction_, image_);
            const Scalar length = norm / curvature;
#pragma omp parallel for num_threads(options_.threads) if (options_.threads > 1)
            for (std::ptrdiff_t node = 0; node < nodes; ++node) {
                change_[node] = change_[node] + length * direction_[node];
                residual_[node] = residual_[node] - length * image_[node];
            }
            const Scalar next = inner_product(residual_, residual_);
            const Scalar ratio = next / norm;
            norm = next;
#pragma omp parallel for num_threads(options_.threads) if (options_.threads > 1)
            for (std::ptrdiff_t node = 0; node < nodes; ++node) {
                direction_[node] = residual_[node] + ratio * direction_[node];
            }
            ++iteration;
        }
        cost.cg_iterations = iteration;
        const double unknowns = 3.0 * static_cast<double>(nodes);
        const auto entries = static_cast<double>(matrix_.size());
        cost.solve_flops = iteration * (18 * entries + 10 * unknowns);
        cost.solve_bytes =
            iteration * (entries * sizeof(Entry) + static_cast<double>(nodes) * sizeof(std::size_t) +
                         13 * unknowns * sizeof(Scalar));  // product 2, inner products 3, updates 8 vectors
    }

    [[nodiscard]] static std::vector<double> flat(const std::vector<Vector>& vectors) {
        std::vector<double> values;
        values.reserve(3 * vectors.size());
        for (const Vector& v : vectors) values.insert(values.end(), {double(v.x), double(v.y), double(v.z)});
        return values;
    }

    BaselineOptions options_;
    Scalar time_step_;
    Scalar damping_mass_;
    Scalar damping_stiffness_;
    Vector gravity_;
    ElementGroups groups_;
    MatrixGraph graph_;
    std::vector<MappedElement> elements_;
    std::vector<Entry> matrix_;
    std::vector<std::size_t> rows_;
    std::vector<Scalar> masses_;
    std::vector<char> fixed_;
    std::vector<Vector> positions_, velocities_, forces_, change_, residual_, direction_, image_, predicted_;
    std::vector<std::vector<Vector>> private_forces_;
};

}  // namespace lancet::experiments::bar
