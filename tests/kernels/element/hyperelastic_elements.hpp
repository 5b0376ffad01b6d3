#pragma once

#include <string>

#include "tests/kernels/layout/layouts_under_test.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/isa/kernel_set.hpp"

namespace lancet::test {

using kernels::AlignedVector;
using kernels::MaterialModel;
using kernels::TangentKind;

/// The elements of a solid in batches, driven by the kernels alone, block after block.
template <class Real>
class HyperelasticElements {
  public:
    HyperelasticElements(const ReferenceSolid& solid, kernels::InstructionSet instruction_set, ScatterStrategy scatter)
        : kernels(kernels::kernel_set<Real>(instruction_set)),
          numbering(numbered(solid, layout_options)),
          batches(batches_of<Real>(solid, numbering, scatter, kernels.width)),
          position(static_cast<std::size_t>(numbering.node_count) * 4),
          quaternion(static_cast<std::size_t>(batches.slots()) * 4),
          buffer(static_cast<std::size_t>(batches.scatter.buffer_size()) * 4),
          energy(static_cast<std::size_t>(numbering.blocks())),
          element_blocks(static_cast<std::size_t>(batches.slots() + batches.width) * kernels::element_block_entries) {
        const auto width = static_cast<std::size_t>(batches.width);
        for (std::size_t i = 0; i < quaternion.size(); ++i) quaternion[i] = (i / width) % 4 == 0 ? Real(1) : Real(0);
    }

    std::size_t place(std::size_t node, std::size_t axis) const {
        return 4 * static_cast<std::size_t>(numbering.internal_of_user[node]) + axis;
    }
    void set_positions(const Eigen::VectorXd& x) { put(x, position); }

    /// Sums -dW/dx into the buffer's nodes; returns the energy.
    double evaluate(MaterialModel model) {
        const kernels::HyperelasticArguments<Real> call = arguments(model, TangentKind::exact);
        scatter([&](int block) { kernels.hyperelastic.evaluate(call, block); });
        double sum = 0;
        for (const double of_block : energy) sum += of_block;
        return sum;
    }
    void compute_element_blocks(MaterialModel model, TangentKind kind) {
        const kernels::HyperelasticArguments<Real> call = arguments(model, kind);
        for (int block = 0; block < numbering.blocks(); ++block) kernels.hyperelastic.tangent(call, block);
    }

    /// Opens the buffer, lets every block add to it, and merges.
    template <class Add>
    void scatter(Add add) {
        scatter_with(batches.scatter, buffer, add);
    }
    template <class Add>
    void scatter_with(const kernels::ScatterPlan& plan, AlignedVector<Real>& y, Add add) {
        const kernels::OpenArguments<Real> open{.block_begin = numbering.block_begin.data(),
                                                .slot_begin = plan.slot_begin().data(),
                                                .slot_end = plan.slot_end().data(),
                                                .mass = nullptr,
                                                .z = nullptr,
                                                .y = y.data(),
                                                .quadratic = nullptr,
                                                .clear_slots = plan.strategy() != ScatterStrategy::node_gather};
        for (int block = 0; block < numbering.blocks(); ++block) kernels.matrix.open(open, block);
        for (int block = 0; block < numbering.blocks(); ++block) add(block);
        for (int block = 0; block < numbering.blocks(); ++block) {
            kernels.matrix.merge(plan.merge_begin().data(), plan.merges().data(), y.data(), block);
        }
    }

    /// The values at the free nodes, zero at the fixed ones.
    Eigen::VectorXd at_free_nodes(const ReferenceSolid& solid, const AlignedVector<Real>& nodal) const {
        const std::vector<std::uint8_t> is_free = solid.free_unknowns();
        Eigen::VectorXd values = Eigen::VectorXd::Zero(solid.unknowns());
        for (std::size_t i = 0; i < is_free.size(); ++i) {
            if (is_free[i] != 0) values[static_cast<Eigen::Index>(i)] = static_cast<double>(nodal[place(i / 3, i % 3)]);
        }
        return values;
    }
    template <class Number>
    void put(const Eigen::VectorXd& vector, AlignedVector<Number>& nodal) const {
        for (Eigen::Index i = 0; i < vector.size(); ++i) {
            nodal[place(static_cast<std::size_t>(i) / 3, static_cast<std::size_t>(i) % 3)] =
                static_cast<Number>(vector[i]);
        }
    }

    /// K_ij of an element, i < j.
    Eigen::Matrix3d element_block(std::size_t element, int i, int j) const {
        const auto width = static_cast<std::size_t>(batches.width);
        const auto slot = static_cast<std::size_t>(batches.slot_of_element[element]);
        Eigen::Matrix3d k;
        for (int entry = 0; entry < 9; ++entry) {
            const auto at = static_cast<std::size_t>(9 * kernels::element_block_index(i, j) + entry);
            k(entry / 3, entry % 3) = static_cast<double>(
                element_blocks[(slot / width * kernels::element_block_entries + at) * width + slot % width]);
        }
        return k;
    }
    /// The stiffness of an element from its edge blocks.
    Eigen::Matrix<double, 12, 12> element_stiffness(std::size_t element) const {
        Eigen::Matrix<double, 12, 12> k = Eigen::Matrix<double, 12, 12>::Zero();
        for (int i = 0; i < 4; ++i) {
            for (int j = i + 1; j < 4; ++j) {
                const Eigen::Matrix3d block = element_block(element, i, j);
                k.block<3, 3>(3 * i, 3 * j) = block;
                k.block<3, 3>(3 * j, 3 * i) = block.transpose();
                k.block<3, 3>(3 * i, 3 * i) -= block;
                k.block<3, 3>(3 * j, 3 * j) -= block.transpose();
            }
        }
        return k;
    }

    kernels::HyperelasticArguments<Real> arguments(MaterialModel model, TangentKind kind) {
        return {.block_batch_begin = batches.block_batch_begin.data(),
                .nodes = batches.nodes.data(),
                .targets = batches.targets.data(),
                .rest = batches.rest.data(),
                .positions = position.data(),
                .start = nullptr,
                .quaternion = quaternion.data(),
                .force = buffer.data(),
                .energy = energy.data(),
                .element_blocks = element_blocks.data(),
                .model = model,
                .tangent = kind,
                .rotation_steps = 1,
                .exclusive_slots = exclusive_slots()};
    }
    bool exclusive_slots() const { return batches.scatter.strategy() == ScatterStrategy::node_gather; }

    const kernels::KernelSet<Real>& kernels;
    NodeNumbering numbering;
    kernels::ElementBatches<Real> batches;
    AlignedVector<double> position;
    AlignedVector<Real> quaternion;
    AlignedVector<Real> buffer;
    AlignedVector<double> energy;
    AlignedVector<Real> element_blocks;
};

/// An instruction set and a scalar.
struct ElementArithmetic {
    kernels::InstructionSet instruction_set;
    bool single;

    double epsilon() const { return single ? 0x1p-23 : 0x1p-52; }
};

inline std::vector<ElementArithmetic> element_arithmetics() {
    std::vector<ElementArithmetic> all;
    for (const kernels::InstructionSet instruction_set : kernels::compiled_instruction_sets()) {
        for (const bool single : {true, false}) all.push_back({instruction_set, single});
    }
    return all;
}
inline std::string arithmetic_name(const ::testing::TestParamInfo<ElementArithmetic>& info) {
    return std::string(to_string(info.param.instruction_set)) + (info.param.single ? "_float" : "_double");
}

/// Tests over every arithmetic; skips what this machine cannot execute.
class ElementTest : public ::testing::TestWithParam<ElementArithmetic> {
  protected:
    void SetUp() override {
        if (!kernels::is_executable(GetParam().instruction_set)) {
            GTEST_SKIP() << "not run: this processor cannot execute " << to_string(GetParam().instruction_set);
        }
    }
    double epsilon() const { return GetParam().epsilon(); }
    /// Calls check(elements) with the elements of a solid in the test's scalar.
    template <class Check>
    void with_elements(const ReferenceSolid& solid, ScatterStrategy scatter, Check check) {
        if (GetParam().single) {
            HyperelasticElements<float> elements(solid, GetParam().instruction_set, scatter);
            check(elements);
        } else {
            HyperelasticElements<double> elements(solid, GetParam().instruction_set, scatter);
            check(elements);
        }
    }
};

inline constexpr std::array all_materials{MaterialModel::linear, MaterialModel::corotational,
                                          MaterialModel::st_venant_kirchhoff};
inline constexpr std::array all_tangents{TangentKind::rotated, TangentKind::exact, TangentKind::projected};

/// The largest nodal force that a strain of 1 would cause: stress times the area that a node answers for.
inline double force_of_unit_strain(const ReferenceSolid& solid, double spacing) {
    double stiffest = 0;
    for (const ReferenceMaterial& m : solid.materials) stiffest = std::max(stiffest, 3 * m.lambda() + 2 * m.mu());
    return stiffest * spacing * spacing;
}

}  // namespace lancet::test
