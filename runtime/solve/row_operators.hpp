#pragma once

#include "lancet/kernels/layout/row_pattern.hpp"
#include "lancet/runtime/solve/operator.hpp"

namespace lancet::runtime {

/// 3 x 3 blocks in the order of a row pattern, gathered from the elements' rotated gradients.
template <class Real>
class BlockMatrix {
  public:
    BlockMatrix(kernels::RowContent content, ElasticElements<Real>& elements, const OperatorDefinition& definition);

    /// values = stiffness_factor K (+ mass_factor M where the definition's mass is consistent) for every block stored.
    void assemble(Scheduler& scheduler, double stiffness_factor, double mass_factor);

    const kernels::RowPattern& pattern() const noexcept { return pattern_; }
    const Real* values() const noexcept { return values_.data(); }
    std::span<Real> values() noexcept { return values_; }
    kernels::RowArguments<Real> arguments() const noexcept;
    std::size_t bytes() const noexcept;

  private:
    void set_entry_mass(double mass_factor);

    ElasticElements<Real>* elements_;
    kernels::RowPattern pattern_;
    MassKind mass_;
    double entry_mass_factor_ = 0;
    kernels::AlignedVector<Real> values_;      ///< [entry][9][lane]
    kernels::AlignedVector<Real> entry_mass_;  ///< [entry][lane]: off-diagonal consistent mass, as its zero-sum part
};

/// The step matrix as assembled blocks: edge blocks or block rows.
template <class Real>
class RowOperator final : public Operator<Real> {
  public:
    using typename Operator<Real>::Factors;
    using typename Operator<Real>::Work;

    RowOperator(OperatorKind kind, ElasticElements<Real>& elements, const OperatorDefinition& definition);

    OperatorKind kind() const noexcept override { return kind_; }
    void assemble(Scheduler& scheduler, const Factors& factors) override;
    std::size_t bytes() const noexcept override;
    Work work() const noexcept override;

    BlockMatrix<Real>& matrix() noexcept { return matrix_; }

  private:
    void add_product(const kernels::ProductArguments<Real>& product, int block) const override;

    OperatorKind kind_;
    BlockMatrix<Real> matrix_;
};

}  // namespace lancet::runtime
