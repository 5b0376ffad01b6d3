#include "lancet/runtime/solve/row_operators.hpp"

namespace lancet::runtime {

using kernels::RowContent;

template <class Real>
BlockMatrix<Real>::BlockMatrix(RowContent content, ElasticElements<Real>& elements,
                               const OperatorDefinition& definition)
    : elements_(&elements),
      pattern_(kernels::make_row_pattern(content, definition.tetrahedra, elements.batches().slot_of_element,
                                         elements.batches().slots(), elements.numbering(), definition.scatter,
                                         elements.batches().width)),
      mass_(definition.mass) {
    const auto lanes = static_cast<std::size_t>(pattern_.entries()) * static_cast<std::size_t>(pattern_.width);
    values_.resize(9 * lanes);
    if (mass_ == MassKind::consistent) entry_mass_.resize(lanes);
}

template <class Real>
void BlockMatrix<Real>::set_entry_mass(double mass_factor) {
    if (entry_mass_factor_ == mass_factor) return;
    entry_mass_factor_ = mass_factor;
    const auto width = static_cast<std::size_t>(pattern_.width);
    const std::int32_t nothing = 16 * elements_->batches().slots();
    for (std::size_t entry = 0; entry < static_cast<std::size_t>(pattern_.entries()); ++entry) {
        for (std::size_t lane = 0; lane < width; ++lane) {
            double mass = 0;
            for (std::int32_t k = pattern_.incidence_begin[entry]; k < pattern_.incidence_begin[entry + 1]; ++k) {
                const std::int32_t* corners = &pattern_.incidence[static_cast<std::size_t>(k) * 2 * width];
                const std::int32_t row = corners[lane], column = corners[width + lane];
                if (row == nothing) continue;
                // On the diagonal the row sum is nodal: what is left is minus the masses of the corner's pairs.
                const std::size_t slot = row >> 4, i = (row >> 2) & 3, j = (column >> 2) & 3;
                const Real* pairs = &elements_->batches().pair_mass[slot / width * 6 * width + slot % width];
                const auto pair = [&](std::size_t a, std::size_t b) {
                    return static_cast<double>(pairs[kernels::pair_of_corners(a, b) * width]);
                };
                if (i != j) {
                    mass += pair(i, j);
                } else {
                    for (std::size_t other = 0; other < 4; ++other) mass -= other == i ? 0 : pair(i, other);
                }
            }
            entry_mass_[entry * width + lane] = static_cast<Real>(mass_factor * mass);
        }
    }
}

template <class Real>
void BlockMatrix<Real>::assemble(Scheduler& scheduler, double stiffness_factor, double mass_factor) {
    if (mass_ == MassKind::consistent) set_entry_mass(mass_factor);
    const kernels::AssemblyArguments<Real> arguments{.block_chunk_begin = pattern_.block_chunk_begin.data(),
                                                     .chunk_entry_begin = pattern_.chunk_entry_begin.data(),
                                                     .incidence_begin = pattern_.incidence_begin.data(),
                                                     .incidence = pattern_.incidence.data(),
                                                     .rotated = elements_->rotated(),
                                                     .rest = elements_->batches().rest.data(),
                                                     .entry_mass = entry_mass_.empty() ? nullptr : entry_mass_.data(),
                                                     .values = values_.data(),
                                                     .stiffness_factor = static_cast<Real>(stiffness_factor),
                                                     .layout = elements_->layout()};
    scheduler.for_each_block(elements_->numbering().blocks(),
                             [&](int block) { elements_->kernels().matrix.assemble(arguments, block); });
}

template <class Real>
kernels::RowArguments<Real> BlockMatrix<Real>::arguments() const noexcept {
    return {.block_chunk_begin = pattern_.block_chunk_begin.data(),
            .chunk_entry_begin = pattern_.chunk_entry_begin.data(),
            .row = pattern_.row.data(),
            .row_target = pattern_.row_target.data(),
            .column = pattern_.column.data(),
            .column_target = pattern_.column_target.data(),
            .values = values_.data()};
}

template <class Real>
std::size_t BlockMatrix<Real>::bytes() const noexcept {
    return pattern_.bytes() + kernels::heap_bytes(values_) + kernels::heap_bytes(entry_mass_);
}

template <class Real>
RowOperator<Real>::RowOperator(OperatorKind kind, ElasticElements<Real>& elements, const OperatorDefinition& definition)
    : Operator<Real>(elements, definition.nodal_mass),
      kind_(kind),
      matrix_(kind == OperatorKind::edge_blocks ? RowContent::upper_edges : RowContent::full_rows, elements,
              definition) {
    this->set_plan(matrix_.pattern().scatter);
}

template <class Real>
void RowOperator<Real>::assemble(Scheduler& scheduler, const Factors& factors) {
    this->set_factors(factors);
    matrix_.assemble(scheduler, factors.stiffness, factors.mass);
}

template <class Real>
void RowOperator<Real>::add_product(const kernels::ProductArguments<Real>& product, int block) const {
    if (kind_ == OperatorKind::edge_blocks) {
        this->kernels().matrix.edge_blocks(product, matrix_.arguments(), block);
    } else {
        this->kernels().matrix.block_rows(product, matrix_.arguments(), block);
    }
}

template <class Real>
std::size_t RowOperator<Real>::bytes() const noexcept {
    return Operator<Real>::bytes() + matrix_.bytes();
}

template <class Real>
typename Operator<Real>::Work RowOperator<Real>::work() const noexcept {
    // An edge: 3 differences, two products of 18, 3 + 3 additions at its ends, 6 for the quadratic form. A block of a
    // row: 18. A node: mass, and the row's sum. Bytes: values, columns, targets, and three nodal vectors.
    const auto blocks = static_cast<double>(matrix_.pattern().blocks_stored);
    const auto nodes = static_cast<double>(this->numbering().free_count);
    const bool is_half = kind_ == OperatorKind::edge_blocks;
    return {.flops = blocks * (is_half ? 51 : 18) + nodes * 15,
            .bytes = blocks * (9 * sizeof(Real) + (is_half ? 8.0 : 4.0)) + nodes * (3 * 4 + 1) * sizeof(Real)};
}

template class BlockMatrix<float>;
template class BlockMatrix<double>;
template class RowOperator<float>;
template class RowOperator<double>;

}  // namespace lancet::runtime
