#pragma once

#include <optional>
#include <vector>

#include "lancet/kernels/layout/row_pattern.hpp"
#include "lancet/runtime/solve/operator.hpp"

namespace lancet::runtime {

/// 3 x 3 blocks in the order of a row pattern, gathered from the elements' rotated gradients.
template <class Real>
class BlockMatrix {
  public:
    BlockMatrix(kernels::RowContent content, ElasticElements<Real>& elements, const OperatorDefinition& definition);

    /// values = stiffness_factor K (+ mass_factor M where the definition's mass is consistent) for every block stored.
    void assemble(Scheduler& scheduler, double stiffness_factor, double mass_factor, bool only_stale = false);

    /// Takes up elements that have changed, after the elements themselves have; of content upper_edges only. False
    /// where there is no room. `blocks` receives the blocks of rows that have changed.
    bool change(const LayoutChange& change, std::vector<int>& blocks);

    const kernels::RowPattern& pattern() const noexcept { return pattern_; }
    const Real* values() const noexcept { return values_.data(); }
    std::span<Real> values() noexcept { return values_; }
    kernels::RowArguments<Real> arguments() const noexcept;
    std::size_t bytes() const noexcept;

  private:
    void set_entry_mass(double mass_factor);
    Real mass_at(std::size_t entry, std::size_t lane) const;

    ElasticElements<Real>* elements_;
    kernels::RowPattern pattern_;
    std::optional<kernels::RowPatternChanges> changes_;  ///< once there has been one
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
    void assemble(Scheduler& scheduler, const Factors& factors, bool only_stale) override;
    std::size_t bytes() const noexcept override;
    Work work() const noexcept override;

    bool change(const LayoutChange& change) override;
    /// The blocks of rows that the last change has changed.
    const std::vector<int>& changed_blocks() const noexcept { return changed_blocks_; }

    BlockMatrix<Real>& matrix() noexcept { return matrix_; }

  private:
    void add_product(const kernels::ProductArguments<Real>& product, int block) const override;

    OperatorKind kind_;
    BlockMatrix<Real> matrix_;
    std::vector<int> changed_blocks_;
};

}  // namespace lancet::runtime
