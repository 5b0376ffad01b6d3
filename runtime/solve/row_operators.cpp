#include "lancet/runtime/solve/row_operators.hpp"

#include <algorithm>

#include "lancet/runtime/solve/block_loop.hpp"

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
Real BlockMatrix<Real>::mass_at(std::size_t entry, std::size_t lane) const {
    const auto width = static_cast<std::size_t>(pattern_.width);
    const std::int32_t nothing = pattern_.nothing();
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
    return static_cast<Real>(entry_mass_factor_ * mass);
}

template <class Real>
void BlockMatrix<Real>::set_entry_mass(double mass_factor) {
    if (entry_mass_factor_ == mass_factor) return;
    entry_mass_factor_ = mass_factor;
    const auto width = static_cast<std::size_t>(pattern_.width);
    for (std::size_t entry = 0; entry < static_cast<std::size_t>(pattern_.entries()); ++entry) {
        for (std::size_t lane = 0; lane < width; ++lane) entry_mass_[entry * width + lane] = mass_at(entry, lane);
    }
}

template <class Real>
bool BlockMatrix<Real>::change(const LayoutChange& change, std::vector<int>& blocks) {
    if (pattern_.room_begin.empty()) return false;
    const kernels::NodeNumbering& numbering = elements_->numbering();
    if (!changes_) changes_.emplace(pattern_, numbering);
    changes_->forget_changed_places();
    for (const kernels::ElementMove& move : change.moves) {
        if (!changes_->enter(pattern_, numbering, move)) return false;
    }
    pattern_.scatter.finish_changes();
    const auto width = static_cast<std::size_t>(pattern_.width);
    std::vector<bool> is_changed(static_cast<std::size_t>(numbering.blocks()));
    for (const std::int32_t place : changes_->changed_places()) {
        const std::size_t entry = static_cast<std::size_t>(place) / width;
        const auto chunk = std::upper_bound(pattern_.chunk_entry_begin.begin(), pattern_.chunk_entry_begin.end(),
                                            static_cast<std::int32_t>(entry)) -
                           pattern_.chunk_entry_begin.begin() - 1;
        const std::int32_t row = pattern_.row[static_cast<std::size_t>(chunk) * width + place % width] / 4;
        is_changed[static_cast<std::size_t>(chunk < pattern_.room_begin.front() ? numbering.block_of(row)
                                                                                : numbering.first_blocks())] = true;
    }
    if (!entry_mass_.empty()) {
        const auto take_mass = [&](std::int32_t entry, std::int32_t lane) {
            entry_mass_[static_cast<std::size_t>(entry) * width + static_cast<std::size_t>(lane)] =
                mass_at(static_cast<std::size_t>(entry), static_cast<std::size_t>(lane));
        };
        for (const std::int32_t place : changes_->changed_places()) {
            take_mass(place / pattern_.width, place % pattern_.width);
        }
        // Elements may have changed in weight alone.
        for (const kernels::ElementMove& move : change.moves) {
            if (move.after[0] >= 0) changes_->for_each_place(pattern_, numbering, move.after, take_mass);
        }
    }
    blocks.clear();
    for (std::size_t block = 0; block < is_changed.size(); ++block) {
        if (is_changed[block]) blocks.push_back(static_cast<int>(block));
    }
    return true;
}

template <class Real>
void BlockMatrix<Real>::assemble(Scheduler& scheduler, double stiffness_factor, double mass_factor, bool only_stale) {
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
    const std::span<const std::uint8_t> stale =
        only_stale ? elements_->stale_blocks() : std::span<const std::uint8_t>();
    for_each_awake_block(scheduler, elements_->numbering(), [&](int block) {
        if (!stale.empty() && stale[static_cast<std::size_t>(block)] == 0) return;
        elements_->kernels().matrix.assemble(arguments, block);
    });
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
    return pattern_.bytes() + kernels::heap_bytes(values_) + kernels::heap_bytes(entry_mass_) +
           (changes_ ? changes_->bytes() : 0);
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
bool RowOperator<Real>::change(const LayoutChange& change) {
    return Operator<Real>::change(change) && matrix_.change(change, changed_blocks_);
}

template <class Real>
void RowOperator<Real>::assemble(Scheduler& scheduler, const Factors& factors, bool only_stale) {
    this->set_factors(factors);
    matrix_.assemble(scheduler, factors.stiffness, factors.mass, only_stale);
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
