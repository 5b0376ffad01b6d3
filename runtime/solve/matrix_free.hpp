#pragma once

#include "lancet/runtime/solve/operator.hpp"

namespace lancet::runtime {

/// The step matrix as its elements: nothing is assembled, a product streams the rotated gradients.
template <class Real>
class MatrixFree final : public Operator<Real> {
  public:
    using typename Operator<Real>::Factors;
    using typename Operator<Real>::Work;

    MatrixFree(ElasticElements<Real>& elements, const OperatorDefinition& definition);

    OperatorKind kind() const noexcept override { return OperatorKind::matrix_free; }
    void assemble(Scheduler& scheduler, const Factors& factors, bool only_stale) override;
    bool change(const LayoutChange& change) override;
    std::size_t bytes() const noexcept override;
    Work work() const noexcept override;

  private:
    void add_product(const kernels::ProductArguments<Real>& product, int block) const override;

    MassKind mass_;
    double pair_mass_factor_ = 0;
    kernels::AlignedVector<Real> pair_mass_;  ///< as ElementBatches::pair_mass, times the factor
};

}  // namespace lancet::runtime
