#include "lancet/experiments/microbench/solver_parts.hpp"

#include <cstdint>

#include "lancet/kernels/isa/kernel_set.hpp"

namespace lancet::experiments {

using runtime::OperatorKind;
using runtime::PreconditionerKind;

namespace {

template <class Real>
runtime::ElasticElements<Real> make_elements(const BentBar& bar, kernels::InstructionSet instruction_set,
                                             OperatorKind kind, const runtime::RotationSettings& rotation) {
    const kernels::KernelSet<Real>& kernels = kernels::kernel_set<Real>(instruction_set);
    const std::vector<std::int32_t> regions(bar.mesh.tetrahedra().size(), 0);
    const std::array<kernels::ElasticParameters, 1> parameters{runtime::elastic_parameters(BentBar::material)};
    return runtime::ElasticElements<Real>(
        kernels,
        kernels::make_element_batches<Real>(bar.mesh.nodes(), bar.mesh.tetrahedra(), regions, parameters, bar.numbering,
                                            kernels::ScatterStrategy::private_copies, kernels.width),
        bar.numbering, runtime::gradient_layout(kind), rotation);
}

}  // namespace

template <class Real>
SolverParts<Real>::SolverParts(const BentBar& bar, runtime::Scheduler& scheduler,
                               kernels::InstructionSet instruction_set, OperatorKind kind,
                               const runtime::RotationSettings& rotation)
    : bar_(&bar),
      scheduler_(&scheduler),
      elements_(make_elements<Real>(bar, instruction_set, kind, rotation)),
      operator_(runtime::make_operator(kind, elements_, definition())) {
    z_.reserve(bar.random[0].size());
    for (const double value : bar.random[0]) z_.push_back(static_cast<Real>(value));
    elements_.reset(scheduler, bar.rest.data());
    // A cold start is far away: it takes more steps than a warm one.
    constexpr int evaluations = 8;
    for (int i = 0; i < evaluations; ++i) {
        elements_.evaluate(scheduler, bar.states[state_].data(), {.rotation = true, .force = false});
    }
}

template <class Real>
runtime::OperatorDefinition SolverParts<Real>::definition() const {
    return {.tetrahedra = bar_->mesh.tetrahedra(), .nodal_mass = bar_->nodal_mass};
}

template <class Real>
void SolverParts<Real>::merge_force() {
    scheduler_->for_each_block(bar_->numbering.blocks(), [&](int block) { elements_.merge_force(block); });
}

template <class Real>
void SolverParts<Real>::follow() {
    is_settled_ = false;
    state_ = 1 - state_;
    elements_.evaluate(*scheduler_, bar_->states[state_].data(), {.rotation = true, .force = true});
    merge_force();
}

template <class Real>
void SolverParts<Real>::follow_to_later_state() {
    follow();
    while (state_ == 0) follow();
}

template <class Real>
void SolverParts<Real>::force_of_kept_rotations() {
    elements_.evaluate(*scheduler_, bar_->states[state_].data(), {.rotation = false, .force = true});
    merge_force();
}

template <class Real>
void SolverParts<Real>::assemble() {
    operator_->assemble(*scheduler_, {.mass = 1, .stiffness = BentBar::time_step * BentBar::time_step});
}

template <class Real>
void SolverParts<Real>::multiply() {
    operator_->product(*scheduler_, z_.data());
    scheduler_->for_each_block(bar_->numbering.blocks(), [&](int block) { operator_->merge(block); });
}

template <class Real>
void SolverParts<Real>::settle() {
    if (is_settled_) return;
    follow_to_later_state();
    constexpr int evaluations = 3;
    for (int i = 0; i < evaluations; ++i) {
        elements_.evaluate(*scheduler_, bar_->states[state_].data(), {.rotation = true, .force = false});
    }
    assemble();
    for (const PreconditionerKind kind : {PreconditionerKind::block_jacobi, PreconditionerKind::coarse}) {
        const auto& built = kind == PreconditionerKind::coarse ? coarse_ : block_jacobi_;
        if (built) refresh(kind);
    }
    is_settled_ = true;
}

template <class Real>
void SolverParts<Real>::refresh(PreconditionerKind kind) {
    auto& preconditioner = kind == PreconditionerKind::coarse ? coarse_ : block_jacobi_;
    preconditioner->forget_coarse();
    preconditioner->refresh(*scheduler_, bar_->states[state_].data());
}

template <class Real>
runtime::Preconditioner<Real>& SolverParts<Real>::preconditioner(PreconditionerKind kind) {
    settle();
    auto& preconditioner = kind == PreconditionerKind::coarse ? coarse_ : block_jacobi_;
    if (!preconditioner) {
        // Any change of an aggregate is enough: see refresh.
        constexpr double coarse_change = 0;
        preconditioner =
            std::make_unique<runtime::Preconditioner<Real>>(kind, elements_, *operator_, definition(), coarse_change);
        refresh(kind);
    }
    return *preconditioner;
}

template class SolverParts<float>;
template class SolverParts<double>;

}  // namespace lancet::experiments
