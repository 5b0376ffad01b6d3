// The coarse space of a body that was cut in place: what has few nodes moves with what it hangs on, and nothing with
// what it was cut from.
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/simulate/changed_layout.hpp"
#include "lancet/runtime/simulate/scene_layout.hpp"

namespace lancet::test {
namespace {

using Nodal = kernels::AlignedVector<double>;

constexpr double time_step = 0.05;

/// A free bar, its step matrix and coarse space, as a body has them inside, and its cut along a plane of nodes.
class CutBar {
  public:
    explicit CutBar(int nodes_per_aggregate)
        : numbering_(
              number_scene(scene_, mesh::OrderingKind::hilbert,
                           {.nodes_per_block = 96, .nodes_per_aggregate = nodes_per_aggregate, .spare_nodes = 128})),
          masses_(nodal_masses(scene_, runtime::element_materials(scene_), numbering_)),
          elements_(kernels_,
                    runtime::element_batches<double>(scene_, numbering_, kernels::ScatterStrategy::private_copies,
                                                     kernels_.width),
                    numbering_, gradient_layout(runtime::OperatorKind::edge_blocks, {}), {}),
          definition_{.tetrahedra = scene_.mesh.tetrahedra(), .nodal_mass = masses_},
          matrix_(make_operator(runtime::OperatorKind::edge_blocks, elements_, definition_)),
          preconditioner_(runtime::PreconditionerKind::coarse, elements_, *matrix_, definition_, 0.0),
          rest_(static_cast<std::size_t>(numbering_.node_count) * 4),
          nodes_(scene_.mesh.nodes().begin(), scene_.mesh.nodes().end()) {
        for (std::size_t node = 0; node < nodes_.size(); ++node) {
            std::copy_n(nodes_[node].begin(), 3, &rest_[at(static_cast<Eigen::Index>(node))]);
        }
        elements_.reset(*scheduler_, rest_.data());
        assemble();
    }

    /// Gives the elements beyond x = place, of those that reach down to `bottom`, nodes of their own there.
    void cut(double place, double bottom) {
        const std::span<const mesh::Tetrahedron> tetrahedra = scene_.mesh.tetrahedra();
        runtime::BodyChange change{.first_node = static_cast<std::int32_t>(nodes_.size())};
        std::vector<std::int32_t> copy(nodes_.size(), -1);
        std::vector<double> moved(nodes_.size(), 0.0);
        for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
            double middle = 0;
            for (const std::int32_t node : tetrahedra[e]) middle += nodes_[node][0] / 4;
            if (middle < place) continue;
            runtime::BodyChange::Element element{.element = static_cast<std::int32_t>(e), .nodes = tetrahedra[e]};
            bool is_cut = false;
            const double mass = kernels::tetrahedron_geometry(nodes_, tetrahedra[e]).volume * density / 4;
            for (std::int32_t& node : element.nodes) {
                const auto old = static_cast<std::size_t>(node);
                if (std::abs(nodes_[old][0] - place) > 1e-9 || nodes_[old][1] < bottom) continue;
                is_cut = true;
                moved[old] += mass;
                if (copy[old] < 0) {
                    copy[old] = change.first_node + static_cast<std::int32_t>(change.nodes.size());
                    change.nodes.push_back({.rest = nodes_[old]});
                }
                node = copy[old];
            }
            if (!is_cut) continue;
            element.like = element.element;
            element.material = elastic_parameters(scene_.materials.at(0));
            change.elements.push_back(element);
        }
        runtime::ChangedLayout<double> changed(change, numbering_, spare_nodes_, elements_, rest_);
        runtime::LayoutChange layout;
        ASSERT_TRUE(changed.number_nodes());
        ASSERT_TRUE(changed.lay_out_elements(layout));
        for (const std::int32_t number : changed.numbers()) numbering_.internal_of_user.push_back(number);
        const std::size_t before = copy.size();
        for (std::size_t old = 0; old < before; ++old) {
            if (copy[old] < 0) continue;
            const std::int32_t from = numbering_.internal_of_user[old], to = numbering_.internal_of_user[copy[old]];
            masses_[from] -= moved[old];
            masses_[to] += moved[old];
            for (const std::int32_t node : {from, to}) layout.masses.push_back({.node = node, .mass = masses_[node]});
        }
        for (const auto& node : change.nodes) nodes_.push_back(node.rest);
        ASSERT_TRUE(matrix_->change(layout));
        ASSERT_TRUE(preconditioner_.change(layout));
        assemble();
    }

    int unknowns() { return preconditioner_.coarse()->unknowns(); }
    /// Of the numbering without its room.
    int aggregates() const { return numbering_.block_aggregate_begin[numbering_.first_blocks()]; }
    int aggregates_of_room() const { return numbering_.block_aggregate_begin.back() - aggregates(); }
    Eigen::Index size() const { return 3 * static_cast<Eigen::Index>(nodes_.size()); }
    const std::vector<mesh::Point>& nodes() const { return nodes_; }

    Eigen::VectorXd product(const Eigen::VectorXd& z) {
        const Nodal in = internal(z);
        matrix_->product(*scheduler_, in.data());
        for (int block = 0; block < numbering_.blocks(); ++block) matrix_->merge(block);
        return user({matrix_->buffer(), matrix_->buffer() + in.size()});
    }

    /// Z (Z^T A Z)^-1 Z^T r: the preconditioner without its block-diagonal part.
    Eigen::VectorXd correction(const Eigen::VectorXd& r) {
        auto& coarse = *preconditioner_.coarse();
        const Nodal residual = internal(r);
        Nodal z(residual.size()), none(residual.size() * 2), r_in = residual;
        std::vector<double> sums(static_cast<std::size_t>(numbering_.blocks()));
        const auto modes = coarse.arguments();
        const kernels::ConjugateGradientArguments<double, double> arguments{
            .block_begin = numbering_.block_begin.data(),
            .w = nullptr,
            .z = z.data(),
            .p = nullptr,
            .s = nullptr,
            .x = nullptr,
            .r = r_in.data(),
            .inverse_diagonal = none.data(),
            .alpha = 0,
            .beta = 0,
            .r_dot_z = sums.data(),
            .r_dot_r = sums.data()};
        for (int block = 0; block < numbering_.blocks(); ++block) {
            kernels_.vector.restrict_residual(modes, arguments, block);
            coarse.restrict_to_pieces(residual.data(), block);
        }
        coarse.solve();
        for (int block = 0; block < numbering_.blocks(); ++block) {
            kernels_.vector.precondition_with_coarse(modes, arguments, block);
            coarse.move_pieces(residual.data(), z.data(), block);
        }
        return user(z);
    }

  private:
    static constexpr double density = 500;

    static runtime::Scene bar() {
        runtime::Scene scene;
        scene.mesh = mesh::box({.cells = {10, 4, 3}, .size = {1.0, 0.4, 0.3}});
        scene.materials = {{0, {.young_modulus = 1e5, .poisson_ratio = 0.33, .density = density}}};
        return scene;
    }
    std::size_t at(Eigen::Index node) const { return 4 * static_cast<std::size_t>(numbering_.internal_of_user[node]); }
    Nodal internal(const Eigen::VectorXd& values) const {
        Nodal nodal(static_cast<std::size_t>(numbering_.node_count) * 4, 0.0);
        for (Eigen::Index node = 0; node < values.size() / 3; ++node) {
            for (Eigen::Index axis = 0; axis < 3; ++axis) nodal[at(node) + axis] = values[3 * node + axis];
        }
        return nodal;
    }
    Eigen::VectorXd user(const Nodal& nodal) const {
        Eigen::VectorXd values(size());
        for (Eigen::Index node = 0; node < values.size() / 3; ++node) {
            for (Eigen::Index axis = 0; axis < 3; ++axis) values[3 * node + axis] = nodal[at(node) + axis];
        }
        return values;
    }
    void assemble() {
        elements_.evaluate(*scheduler_, rest_.data(), {});
        matrix_->assemble(*scheduler_, {.mass = 1, .stiffness = time_step * time_step});
        preconditioner_.refresh(*scheduler_, rest_.data());
        ASSERT_EQ(preconditioner_.coarse_failures(), 0);
    }

    std::unique_ptr<runtime::Scheduler> scheduler_ = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    runtime::Scene scene_ = bar();
    kernels::NodeNumbering numbering_;
    kernels::SpareNodes spare_nodes_{numbering_};
    std::vector<double> masses_;
    const kernels::KernelSet<double>& kernels_ = kernels::kernel_set<double>(kernels::active_instruction_set());
    runtime::ElasticElements<double> elements_;
    runtime::OperatorDefinition definition_;
    std::unique_ptr<runtime::Operator<double>> matrix_;
    runtime::Preconditioner<double> preconditioner_;
    Nodal rest_;
    std::vector<mesh::Point> nodes_;
};

/// The rigid motions of the nodes that `takes` says.
template <class Takes>
Eigen::MatrixXd rigid_motions_of(const CutBar& bar, const Takes& takes) {
    Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(bar.size(), 6);
    for (std::size_t node = 0; node < bar.nodes().size(); ++node) {
        if (!takes(node)) continue;
        const Eigen::Vector3d x(bar.nodes()[node].data());
        for (int axis = 0; axis < 3; ++axis) {
            const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
            motions.block<3, 1>(3 * static_cast<Eigen::Index>(node), axis) = unit;
            motions.block<3, 1>(3 * static_cast<Eigen::Index>(node), 3 + axis) = unit.cross(x);
        }
    }
    return motions;
}

void expect_exact_for(CutBar& bar, const Eigen::MatrixXd& motions) {
    for (const Eigen::VectorXd u : motions.colwise()) {
        EXPECT_LE((bar.correction(bar.product(u)) - u).norm(), 1e-8 * u.norm());
    }
}

class LedAggregates : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(NodesPerAggregate, LedAggregates, ::testing::Values(24, 60, 1000));

TEST_P(LedAggregates, RoomThatIsNotUsedHasNoUnknown) {
    CutBar bar(GetParam());
    EXPECT_EQ(bar.unknowns(), 6 * bar.aggregates());
    expect_exact_for(bar, rigid_motions_of(bar, [](std::size_t) { return true; }));
}

// The correction is a projection in the energy of A: C A C = C. Its trace, C A's, is the number of its modes.
TEST_P(LedAggregates, CorrectionIsAProjection) {
    CutBar bar(GetParam());
    ASSERT_NO_FATAL_FAILURE(bar.cut(0.5, 0.15));
    ASSERT_NO_FATAL_FAILURE(bar.cut(0.8, 0.25));
    double trace = 0;
    Eigen::MatrixXd c = Eigen::MatrixXd::Zero(bar.size(), bar.size());
    for (Eigen::Index i = 0; i < bar.size(); ++i) {
        c.col(i) = bar.correction(Eigen::VectorXd::Unit(bar.size(), i));
        const Eigen::VectorXd again = bar.correction(bar.product(c.col(i)));
        EXPECT_LE((again - c.col(i)).norm(), 1e-8 * c.col(i).norm());
        trace += bar.correction(bar.product(Eigen::VectorXd::Unit(bar.size(), i)))[i];
    }
    const Eigen::MatrixXd transposed = c.transpose();
    EXPECT_LE((c - transposed).norm(), 1e-9 * c.norm());
    EXPECT_NEAR(trace, bar.unknowns(), 1e-6);
}

// Two halves that nothing holds: the rigid motions of each are in the space, however small the rims of its own.
TEST_P(LedAggregates, NoneStraddlesACut) {
    CutBar bar(GetParam());
    const std::size_t before = bar.nodes().size();
    ASSERT_NO_FATAL_FAILURE(bar.cut(0.5, -1));
    const auto is_right = [&](std::size_t node) { return node >= before || bar.nodes()[node][0] > 0.5 + 1e-9; };
    expect_exact_for(bar, rigid_motions_of(bar, is_right));
    expect_exact_for(bar, rigid_motions_of(bar, [&](std::size_t node) { return !is_right(node); }));
}

// Twenty copies are one rim, and fit into one aggregate of the room.
TEST(LedAggregates, WhatHangsTogetherComesTogether) {
    CutBar bar(60);
    EXPECT_EQ(bar.aggregates_of_room(), 0);
    ASSERT_NO_FATAL_FAILURE(bar.cut(0.5, -1));
    EXPECT_EQ(bar.aggregates_of_room(), 1);
}

// Twelve copies have few nodes where aggregates have some sixty; they follow, and so does what is severed unless it is
// large.
TEST(LedAggregates, FewNodesAddNoUnknowns) {
    CutBar bar(60);
    const int uncut = bar.unknowns();
    ASSERT_NO_FATAL_FAILURE(bar.cut(0.5, 0.15));
    EXPECT_LE(bar.unknowns(), uncut + 6);
}

}  // namespace
}  // namespace lancet::test
