#include "lancet/runtime/solve/matrix_free.hpp"

namespace lancet::runtime {

template <class Real>
MatrixFree<Real>::MatrixFree(ElasticElements<Real>& elements, const OperatorDefinition& definition)
    : Operator<Real>(elements, definition.nodal_mass),
      mass_(definition.mass),
      pair_mass_(mass_ == MassKind::consistent ? elements.batches().pair_mass.size() : 0) {
    this->set_plan(elements.batches().scatter);
}

template <class Real>
void MatrixFree<Real>::assemble(Scheduler&, const Factors& factors, bool) {
    this->set_factors(factors);
    if (mass_ != MassKind::consistent || pair_mass_factor_ == factors.mass) return;
    pair_mass_factor_ = factors.mass;
    for (std::size_t lane = 0; lane < pair_mass_.size(); ++lane) {
        pair_mass_[lane] =
            static_cast<Real>(factors.mass * static_cast<double>(this->elements().batches().pair_mass[lane]));
    }
}

template <class Real>
bool MatrixFree<Real>::change(const LayoutChange& change) {
    pair_mass_factor_ = 0;  // the elements' masses are scaled anew
    return Operator<Real>::change(change);
}

template <class Real>
void MatrixFree<Real>::add_product(const kernels::ProductArguments<Real>& product, int block) const {
    const kernels::ElementBatches<Real>& batches = this->elements().batches();
    const kernels::MatrixFreeArguments<Real> matrix{.block_batch_begin = batches.block_batch_begin.data(),
                                                    .nodes = batches.nodes.data(),
                                                    .targets = batches.targets.data(),
                                                    .rest = batches.rest.data(),
                                                    .rotated = this->elements().rotated(),
                                                    .pair_mass = pair_mass_.empty() ? nullptr : pair_mass_.data(),
                                                    .stiffness_factor = static_cast<Real>(this->factors().stiffness),
                                                    .layout = this->elements().layout()};
    this->kernels().matrix.matrix_free(product, matrix, block);
}

template <class Real>
std::size_t MatrixFree<Real>::bytes() const noexcept {
    return Operator<Real>::bytes() + kernels::heap_bytes(pair_mass_);
}

template <class Real>
typename Operator<Real>::Work MatrixFree<Real>::work() const noexcept {
    // Per element: 9 differences, 45 for G (9 dot products of 3), 11 for the stress and 6 for its factor, 45 for three
    // forces, 6 for the fourth, 12 for the scatter, 11 for the quadratic form. Gradients, lambda / mu, nodes, targets.
    const auto elements = static_cast<double>(this->elements().batches().slots());
    const auto nodes = static_cast<double>(this->numbering().free_count);
    if (this->elements().layout() == kernels::GradientLayout::element_blocks) {
        // Six edges: a difference of 3, two products of 15, 6 + 6 for sums and quadratic form; 54 numbers.
        return {.flops = elements * 6 * 45 + nodes * 9,
                .bytes = elements * (kernels::element_block_entries * sizeof(Real) + 32.0) +
                         nodes * (4.0 * 3 + 1) * sizeof(Real)};
    }
    return {.flops = elements * 145 + nodes * 9,
            .bytes = elements * (10 * sizeof(Real) + 32.0) + nodes * (4.0 * 3 + 1) * sizeof(Real)};
}

template class MatrixFree<float>;
template class MatrixFree<double>;

}  // namespace lancet::runtime
