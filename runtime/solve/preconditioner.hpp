#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>

#include "lancet/runtime/solve/coarse_space.hpp"
#include "lancet/runtime/solve/operator.hpp"

namespace lancet::runtime {

/// What conjugate gradients are preconditioned with.
enum class PreconditionerKind {
    none,
    jacobi,        ///< the diagonal
    block_jacobi,  ///< the 3 x 3 diagonal blocks
    coarse         ///< block Jacobi plus the rigid-body modes of aggregates of nodes
};
std::string_view to_string(PreconditionerKind kind) noexcept;
PreconditionerKind preconditioner_kind_from_string(std::string_view name);

/// The preconditioner of an operator: block-diagonal inverses and, if asked for, a coarse space.
template <class Real>
class Preconditioner {
  public:
    /// `matrix` and `elements` must outlive it. With a coarse space, which measures how the body has changed, the
    /// preconditioner is refreshed when an aggregate has changed by more than `coarse_change` (see CoarseSpace::change)
    /// since the last time; without one, always.
    Preconditioner(PreconditionerKind kind, ElasticElements<Real>& elements, Operator<Real>& matrix,
                   const OperatorDefinition& definition, double coarse_change);

    /// Takes up the operator, which has just been assembled at `positions`.
    void refresh(Scheduler& scheduler, const double* positions);

    /// Takes up elements that have changed, after the operator has; a refresh comes next. False where there is no room.
    bool change(const LayoutChange& change);

    /// [node / width][6][lane], or nullptr for the identity.
    const Real* inverse_diagonal() const noexcept { return inverse_.empty() ? nullptr : inverse_.data(); }
    /// nullptr if there is none.
    CoarseSpace<Real>* coarse() noexcept { return coarse_ ? &*coarse_ : nullptr; }

    int coarse_refreshes() const noexcept { return coarse_refreshes_; }
    /// Refreshes whose coarse matrix was not positive definite: the coarse space did nothing until the next one.
    int coarse_failures() const noexcept { return coarse_failures_; }
    /// Forces the next refresh to take up the coarse space anew.
    void forget_coarse() noexcept { force_coarse_ = true; }
    std::size_t bytes() const noexcept;

    void save(std::vector<double>& numbers) const;
    /// Reads back what save wrote.
    void restore(std::span<const double>& numbers);

  private:
    void invert_diagonal(Scheduler& scheduler);

    PreconditionerKind kind_;
    ElasticElements<Real>* elements_;
    Operator<Real>* matrix_;
    double coarse_change_;
    bool has_consistent_mass_;
    kernels::AlignedVector<Real> inverse_;
    std::optional<BlockMatrix<Real>> own_edges_;  ///< where the operator itself has none
    std::optional<CoarseSpace<Real>> coarse_;
    typename Operator<Real>::Factors coarse_factors_{};
    bool force_coarse_ = true;
    int coarse_refreshes_ = 0;
    int coarse_failures_ = 0;
};

}  // namespace lancet::runtime
