#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "tests/kernels/layout/layouts_under_test.hpp"
#include "tests/runtime/solve/bodies_under_test.hpp"

#include "lancet/runtime/solve/conjugate_gradients.hpp"

namespace lancet::test {

/// The step matrix of a solid at a deformed state with its preconditioner and solver, as a body has them inside, and
/// the same matrix assembled with Eigen.
template <class Real, class Accumulate>
struct LinearSystem {
    struct Options {
        kernels::InstructionSet instruction_set = kernels::active_instruction_set();
        runtime::OperatorKind kind = runtime::OperatorKind::edge_blocks;
        runtime::PreconditionerKind preconditioner = runtime::PreconditionerKind::coarse;
        kernels::NumberingOptions numbering{.nodes_per_block = 24, .nodes_per_aggregate = 12};
        double time_step = 0.02;
    };
    using Nodal = kernels::AlignedVector<Accumulate>;

    LinearSystem(const ReferenceSolid& of, Eigen::VectorXd at, const Options& options)
        : solid(of),
          positions(std::move(at)),
          numbering(numbered(solid, options.numbering)),
          kernels(kernels::kernel_set<Real>(options.instruction_set)),
          elements(kernels, batches_of<Real>(solid, numbering, ScatterStrategy::private_copies, kernels.width),
                   numbering, gradient_layout(options.kind), {}),
          definition{.tetrahedra = solid.tetrahedra, .nodal_mass = internal_masses()},
          matrix(make_operator(options.kind, elements, definition)),
          preconditioner(options.preconditioner, elements, *matrix, definition, 0.0),
          solver(kernels, numbering),
          factors{.mass = 1, .stiffness = options.time_step * options.time_step} {
        elements.reset(*scheduler, to_internal<double>(solid.rest()).data());
        take_up(positions);
    }

    /// Assembles everything at these positions.
    void take_up(const Eigen::VectorXd& x) {
        positions = x;
        const auto internal = to_internal<double>(x);
        elements.evaluate(*scheduler, internal.data(), {});
        matrix->assemble(*scheduler, factors);
        preconditioner.refresh(*scheduler, internal.data());
    }

    std::vector<double> internal_masses() const {
        std::vector<double> mass(static_cast<std::size_t>(numbering.node_count), 0.0);
        const Eigen::VectorXd diagonal = solid.mass(false).diagonal();
        for (std::size_t node = 0; node < solid.nodes.size(); ++node) {
            mass[numbering.internal_of_user[node]] = diagonal[static_cast<Eigen::Index>(3 * node)];
        }
        return mass;
    }

    template <class Number>
    kernels::AlignedVector<Number> to_internal(const Eigen::VectorXd& values) const {
        kernels::AlignedVector<Number> nodal(static_cast<std::size_t>(numbering.node_count) * 4, Number(0));
        for (std::size_t node = 0; node < solid.nodes.size(); ++node) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                nodal[4 * static_cast<std::size_t>(numbering.internal_of_user[node]) + axis] =
                    static_cast<Number>(values[static_cast<Eigen::Index>(3 * node + axis)]);
            }
        }
        return nodal;
    }
    template <class Number>
    Eigen::VectorXd to_user(const kernels::AlignedVector<Number>& nodal) const {
        Eigen::VectorXd values(solid.unknowns());
        for (std::size_t node = 0; node < solid.nodes.size(); ++node) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                values[static_cast<Eigen::Index>(3 * node + axis)] =
                    static_cast<double>(nodal[4 * static_cast<std::size_t>(numbering.internal_of_user[node]) + axis]);
            }
        }
        return values;
    }

    /// The matrix of all nodes, fixed ones included.
    Eigen::MatrixXd assembled() const {
        return factors.mass * solid.mass(false) + factors.stiffness * solid.stiffness(positions, true);
    }

    /// The same matrix column by column from the operator's own products, in its own scalar: for states in which the
    /// rotation is not unique (a line, a point), and for what rounding of its entries has done. Rows of free nodes.
    Eigen::MatrixXd from_products() {
        Eigen::MatrixXd a(solid.unknowns(), solid.unknowns());
        for (Eigen::Index column = 0; column < a.cols(); ++column) {
            const auto unit = to_internal<Real>(Eigen::VectorXd::Unit(a.cols(), column));
            matrix->product(*scheduler, unit.data());
            for (int block = 0; block < numbering.blocks(); ++block) matrix->merge(block);
            kernels::AlignedVector<Real> result(matrix->buffer(), matrix->buffer() + unit.size());
            a.col(column) = to_user(result);
        }
        return a;
    }

    struct Solution {
        Eigen::VectorXd x;
        runtime::ConjugateGradientResult result;
        std::vector<double> history;
    };
    Solution solve(const Eigen::VectorXd& b, const runtime::ConjugateGradientSettings& settings,
                   const runtime::ConstraintFilter& filter = {}, const Eigen::VectorXd& start = {}) {
        const Nodal right = to_internal<Accumulate>(b);
        Nodal x = to_internal<Accumulate>(start.size() == 0 ? Eigen::VectorXd::Zero(b.size()) : start);
        std::vector<double> history(static_cast<std::size_t>(settings.iterations), -1.0);
        const auto result = solver.solve(*scheduler, *matrix, preconditioner, filter, right, x, settings, history);
        history.resize(static_cast<std::size_t>(result.iterations));
        return {to_user(x), result, history};
    }

    ReferenceSolid solid;
    Eigen::VectorXd positions;
    std::unique_ptr<runtime::Scheduler> scheduler = serial();
    NodeNumbering numbering;
    const kernels::KernelSet<Real>& kernels;
    runtime::ElasticElements<Real> elements;
    runtime::OperatorDefinition definition;
    std::unique_ptr<runtime::Operator<Real>> matrix;
    runtime::Preconditioner<Real> preconditioner;
    runtime::ConjugateGradients<Real, Accumulate> solver;
    typename runtime::Operator<Real>::Factors factors;
};

/// Calls test.template operator()<Real, Accumulate>() for a scalar mode.
template <class Test>
void with_scalars(runtime::ScalarMode scalar, const Test& test) {
    switch (scalar) {
        case runtime::ScalarMode::single_precision:
            test.template operator()<float, float>();
            break;
        case runtime::ScalarMode::mixed:
            test.template operator()<float, double>();
            break;
        default:
            test.template operator()<double, double>();
    }
}

/// A basis of the motions that a solid's fixed nodes and a list of (node, direction) constraints leave; a direction of
/// zero holds the node.
struct NodeHold {
    std::int32_t node;
    Eigen::Vector3d direction;
};
inline Eigen::MatrixXd allowed_motions(const ReferenceSolid& solid, const std::vector<NodeHold>& holds) {
    std::vector<Eigen::VectorXd> columns;
    for (std::int32_t node = 0; node < static_cast<std::int32_t>(solid.nodes.size()); ++node) {
        if (std::find(solid.fixed.begin(), solid.fixed.end(), node) != solid.fixed.end()) continue;
        Eigen::Matrix3d directions = Eigen::Matrix3d::Identity();
        int count = 3;
        for (const NodeHold& hold : holds) {
            if (hold.node != node) continue;
            if (hold.direction.isZero()) {
                count = 0;
            } else {
                directions.col(0) = hold.direction.unitOrthogonal();
                directions.col(1) = hold.direction.cross(Eigen::Vector3d(directions.col(0)));
                count = 2;
            }
        }
        for (int k = 0; k < count; ++k) {
            columns.emplace_back(Eigen::VectorXd::Zero(solid.unknowns()));
            columns.back().segment<3>(3 * node) = directions.col(k);
        }
    }
    Eigen::MatrixXd basis(solid.unknowns(), static_cast<Eigen::Index>(columns.size()));
    for (std::size_t k = 0; k < columns.size(); ++k) basis.col(static_cast<Eigen::Index>(k)) = columns[k];
    return basis;
}
inline runtime::ConstraintFilter filter_of(const std::vector<NodeHold>& holds, const NodeNumbering& numbering) {
    std::vector<runtime::NodeConstraint> constraints;
    for (const NodeHold& hold : holds) {
        Eigen::Matrix3d p = Eigen::Matrix3d::Zero();
        if (!hold.direction.isZero()) {
            p = Eigen::Matrix3d::Identity() - hold.direction * hold.direction.transpose();
        }
        constraints.push_back(
            {numbering.internal_of_user[hold.node], {p(0, 0), p(1, 1), p(2, 2), p(0, 1), p(0, 2), p(1, 2)}});
    }
    return {constraints, numbering};
}

}  // namespace lancet::test
