#pragma once

#include <string>
#include <vector>

#include "tests/kernels/element/reference_material.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/isa/instruction_set.hpp"

namespace lancet::kernels::test {

using lancet::test::PointwiseReference;
using lancet::test::Tangent;

inline constexpr double lambda_over_mu = 1.9;

/// The arithmetic that pointwise laws run in.
struct MaterialArithmetic {
    InstructionSet instruction_set;
    bool single;

    double epsilon() const { return single ? 0x1p-23 : 0x1p-52; }
    std::string name() const { return std::string(to_string(instruction_set)) + (single ? "_float" : "_double"); }
    /// F as the law sees it.
    Eigen::Matrix3d rounded(const Eigen::Matrix3d& f) const;
};

/// One material in one arithmetic; all its functions take a list of states, one per lane, and divide by mu.
struct MaterialRun {
    MaterialArithmetic arithmetic;
    MaterialModel model;

    PointwiseReference reference() const { return {model, lambda_over_mu, 1}; }
    std::vector<double> energy(const std::vector<Eigen::Matrix3d>& f) const;
    std::vector<Eigen::Matrix3d> stress(const std::vector<Eigen::Matrix3d>& f) const;
    std::vector<Eigen::Matrix3d> product(TangentKind kind, const std::vector<Eigen::Matrix3d>& f,
                                         const std::vector<Eigen::Matrix3d>& change) const;
    /// The whole tangent of every state, column by column.
    std::vector<Tangent> tangent(TangentKind kind, const std::vector<Eigen::Matrix3d>& f) const;
};

/// W_i, W_ij, flips and twists as PrincipalDerivatives names them.
struct PrincipalValues {
    Eigen::Vector3d first;
    Eigen::Matrix3d second;
    Eigen::Vector3d flip, twist;
};
PrincipalValues principal(const MaterialRun& run, const Eigen::Vector3d& stretch);

/// F = left diag(stretch) right^T.
struct Decomposition {
    Eigen::Vector3d stretch;
    Eigen::Matrix3d left, right;
};
std::vector<Decomposition> decompose(const MaterialArithmetic& arithmetic, const std::vector<Eigen::Matrix3d>& f);

std::vector<Eigen::Matrix3d> positive_part(const MaterialArithmetic& arithmetic,
                                           const std::vector<Eigen::Matrix3d>& symmetric);

/// A deformation gradient to test at.
struct MaterialState {
    std::string name;
    Eigen::Matrix3d f;
};
/// Near rest, moderate, large, nearly singular, flattened along two axes, and inverted; each in several orientations.
std::vector<MaterialState> material_states();
std::vector<Eigen::Matrix3d> gradients_of(const std::vector<MaterialState>& states);
Eigen::Matrix3d random_matrix(unsigned seed);
Eigen::Matrix3d random_rotation(unsigned seed);

std::vector<MaterialArithmetic> material_arithmetics();
std::vector<MaterialRun> material_runs();
std::string run_name(const ::testing::TestParamInfo<MaterialRun>& info);

/// Skips what this machine cannot execute.
class MaterialTest : public ::testing::TestWithParam<MaterialRun> {
  protected:
    void SetUp() override {
        if (!is_executable(GetParam().arithmetic.instruction_set)) {
            GTEST_SKIP() << "not run: this processor cannot execute "
                         << to_string(GetParam().arithmetic.instruction_set);
        }
    }
    double epsilon() const { return GetParam().arithmetic.epsilon(); }
    MaterialModel model() const { return GetParam().model; }
};

}  // namespace lancet::kernels::test
