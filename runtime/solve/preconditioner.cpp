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
    : kind_(kind), elements_(&elements), matrix_(&matrix), coarse_change_(coarse_change) {
    if (kind == PreconditionerKind::none) return;
    diagonal_.emplace(kernels::RowContent::diagonal, elements, definition);
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
    const auto& factors = matrix_->factors();
    diagonal_->assemble(scheduler, factors.stiffness, factors.mass);
    const kernels::RowPattern& pattern = diagonal_->pattern();
    const kernels::DiagonalArguments<Real> arguments{.block_begin = elements_->numbering().block_begin.data(),
                                                     .block_chunk_begin = pattern.block_chunk_begin.data(),
                                                     .chunk_entry_begin = pattern.chunk_entry_begin.data(),
                                                     .row = pattern.row.data(),
                                                     .values = diagonal_->arguments().values,
                                                     .mass = matrix_->scaled_mass(),
                                                     .inverse = inverse_.data(),
                                                     .blocks = kind_ != PreconditionerKind::jacobi};
    scheduler.for_each_block(elements_->numbering().blocks(),
                             [&](int block) { elements_->kernels().diagonal.invert(arguments, block); });
}

template <class Real>
void Preconditioner<Real>::refresh(Scheduler& scheduler, const double* positions) {
    if (kind_ == PreconditionerKind::none) return;
    invert_diagonal(scheduler);
    if (!coarse_) return;
    const auto& factors = matrix_->factors();
    const bool same_matrix = factors.mass == coarse_factors_.mass && factors.stiffness == coarse_factors_.stiffness;
    if (!force_coarse_ && same_matrix && coarse_->change(scheduler, positions) <= coarse_change_) return;
    if (own_edges_) own_edges_->assemble(scheduler, factors.stiffness, factors.mass);
    force_coarse_ = false;
    coarse_factors_ = factors;
    ++coarse_refreshes_;
    if (!coarse_->refresh(scheduler, positions, matrix_->scaled_mass())) ++coarse_failures_;
}

template <class Real>
std::size_t Preconditioner<Real>::bytes() const noexcept {
    return kernels::heap_bytes(inverse_) + (diagonal_ ? diagonal_->bytes() : 0) +
           (own_edges_ ? own_edges_->bytes() : 0) + (coarse_ ? coarse_->bytes() : 0);
}

template <class Real>
void Preconditioner<Real>::save(std::vector<double>& numbers) const {
    numbers.insert(numbers.end(), {force_coarse_ ? 1.0 : 0.0, coarse_factors_.mass, coarse_factors_.stiffness});
    if (coarse_) coarse_->save(numbers);
}

template <class Real>
void Preconditioner<Real>::restore(Scheduler& scheduler, std::span<const double>& numbers, bool operator_is_assembled) {
    force_coarse_ = numbers[0] != 0;
    coarse_factors_ = {.mass = numbers[1], .stiffness = numbers[2]};
    numbers = numbers.subspan(3);
    if (coarse_) coarse_->restore(numbers);
    if (kind_ != PreconditionerKind::none && operator_is_assembled) invert_diagonal(scheduler);
}

template class Preconditioner<float>;
template class Preconditioner<double>;

}  // namespace lancet::runtime
