#pragma once

#include <array>
#include <memory>
#include <vector>

#include "lancet/experiments/microbench/bent_bar.hpp"
#include "lancet/kernels/isa/instruction_set.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"
#include "lancet/runtime/solve/elastic_elements.hpp"
#include "lancet/runtime/solve/operator.hpp"
#include "lancet/runtime/solve/preconditioner.hpp"

namespace lancet::experiments {

/// The elements of a bent bar with one operator and its preconditioners, as a simulation holds them. `Real` is float or
/// double; bar and scheduler must outlive it.
template <class Real>
class SolverParts {
  public:
    SolverParts(const BentBar& bar, runtime::Scheduler& scheduler, kernels::InstructionSet instruction_set,
                runtime::OperatorKind kind, const runtime::RotationSettings& rotation = {});

    /// Goes to the other state of the bar: rotations from those of the state before, rotated gradients, and the
    /// complete force on every node.
    void follow();
    /// Follows until the later state is reached from the earlier one.
    void follow_to_later_state();
    /// The force where the bar is, from the rotated gradients as they are.
    void force_of_kept_rotations();
    void assemble();
    /// A z on every node, for random z; see BentBar.
    void multiply();
    /// Converges the rotations in the later state and assembles the operator, unless nothing has changed since.
    void settle();

    /// Takes up the operator, with a coarse space (if the kind has one) formed anew.
    void refresh(runtime::PreconditionerKind kind);
    /// Of the settled operator.
    runtime::Preconditioner<Real>& preconditioner(runtime::PreconditionerKind kind);

    const BentBar& bar() const noexcept { return *bar_; }
    runtime::Scheduler& scheduler() const noexcept { return *scheduler_; }
    const kernels::KernelSet<Real>& kernels() const noexcept { return elements_.kernels(); }
    const Real* force() const noexcept { return elements_.force(); }
    const Real* product() const noexcept { return operator_->buffer(); }
    typename runtime::Operator<Real>::Work product_work() const noexcept { return operator_->work(); }
    std::size_t bytes() const noexcept { return operator_->bytes(); }

  private:
    runtime::OperatorDefinition definition() const;
    void merge_force();

    const BentBar* bar_;
    runtime::Scheduler* scheduler_;
    runtime::ElasticElements<Real> elements_;
    std::unique_ptr<runtime::Operator<Real>> operator_;
    std::unique_ptr<runtime::Preconditioner<Real>> block_jacobi_;
    std::unique_ptr<runtime::Preconditioner<Real>> coarse_;
    kernels::AlignedVector<Real> z_;
    std::size_t state_ = 0;
    bool is_settled_ = false;
};

}  // namespace lancet::experiments
