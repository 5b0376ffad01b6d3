#include "lancet/runtime/solve/preconditioner.hpp"

#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {

std::string_view to_string(PreconditionerKind kind) noexcept {
    switch (kind) {
        case PreconditionerKind::none:
            return "none";
        case PreconditionerKind::jacobi:
            return "jacobi";
        case PreconditionerKind::block_jacobi:
            return "block-jacobi";
        default:
            return "coarse";
    }
}

PreconditionerKind preconditioner_kind_from_string(std::string_view name) {
    for (const auto kind : {PreconditionerKind::none, PreconditionerKind::jacobi, PreconditionerKind::block_jacobi,
                            PreconditionerKind::coarse}) {
        if (to_string(kind) == name) return kind;
    }
    throw Error("unknown preconditioner '" + std::string(name) + "'; expected none, jacobi, block-jacobi or coarse");
}

template <class Real>
Preconditioner<Real>::Preconditioner(PreconditionerKind kind, ElasticElements<Real>& elements, Operator<Real>& matrix,
                                     const OperatorDefinition& definition, double coarse_change)
    : kind_(kind),
      elements_(&elements),
      matrix_(&matrix),
      coarse_change_(coarse_change),
      has_consistent_mass_(definition.mass == MassKind::consistent) {
    if (kind == PreconditionerKind::none) return;
    inverse_.resize(static_cast<std::size_t>(elements.numbering().free_count) * 6);
    if (kind != PreconditionerKind::coarse) return;
    if (matrix.kind() == OperatorKind::edge_blocks) {
        coarse_.emplace(elements.kernels(), elements.numbering(), static_cast<RowOperator<Real>&>(matrix).matrix());
    } else {
        own_edges_.emplace(kernels::RowContent::upper_edges, elements, definition);
        coarse_.emplace(elements.kernels(), elements.numbering(), *own_edges_);
    }
}

template <class Real>
void Preconditioner<Real>::invert_diagonal(Scheduler& scheduler) {
    elements_->invert_diagonal(scheduler,
                               {.stiffness_factor = matrix_->factors().stiffness,
                                .mass_factor = matrix_->factors().mass,
                                .nodal_mass = matrix_->scaled_mass(),
                                .has_consistent_mass = has_consistent_mass_,
                                .blocks = kind_ != PreconditionerKind::jacobi},
                               inverse_);
}

template <class Real>
void Preconditioner<Real>::refresh(Scheduler& scheduler, const double* positions) {
    if (kind_ == PreconditionerKind::none) return;
    const auto& factors = matrix_->factors();
    if (!coarse_) return invert_diagonal(scheduler);
    const bool same_matrix = factors.mass == coarse_factors_.mass && factors.stiffness == coarse_factors_.stiffness;
    if (!force_coarse_ && same_matrix && coarse_->change(scheduler, positions) <= coarse_change_) return;
    invert_diagonal(scheduler);
    if (own_edges_) own_edges_->assemble(scheduler, factors.stiffness, factors.mass);
    force_coarse_ = false;
    coarse_factors_ = factors;
    ++coarse_refreshes_;
    if (!coarse_->refresh(scheduler, positions, matrix_->scaled_mass())) ++coarse_failures_;
}

template <class Real>
bool Preconditioner<Real>::change(const LayoutChange& change) {
    forget_coarse();
    if (!coarse_) return true;
    if (!own_edges_) {
        coarse_->change(static_cast<RowOperator<Real>&>(*matrix_).changed_blocks());
        return true;
    }
    std::vector<int> blocks;
    if (!own_edges_->change(change, blocks)) return false;
    coarse_->change(blocks);
    return true;
}

template <class Real>
std::size_t Preconditioner<Real>::bytes() const noexcept {
    return kernels::heap_bytes(inverse_) + (own_edges_ ? own_edges_->bytes() : 0) + (coarse_ ? coarse_->bytes() : 0);
}

template <class Real>
void Preconditioner<Real>::save(std::vector<double>& numbers) const {
    numbers.insert(numbers.end(), {force_coarse_ ? 1.0 : 0.0, coarse_factors_.mass, coarse_factors_.stiffness});
    numbers.insert(numbers.end(), inverse_.begin(), inverse_.end());
    if (coarse_) coarse_->save(numbers);
}

template <class Real>
void Preconditioner<Real>::restore(std::span<const double>& numbers) {
    force_coarse_ = numbers[0] != 0;
    coarse_factors_ = {.mass = numbers[1], .stiffness = numbers[2]};
    numbers = numbers.subspan(3);
    for (std::size_t i = 0; i < inverse_.size(); ++i) inverse_[i] = static_cast<Real>(numbers[i]);
    numbers = numbers.subspan(inverse_.size());
    if (coarse_) coarse_->restore(numbers);
}

template class Preconditioner<float>;
template class Preconditioner<double>;

}  // namespace lancet::runtime
