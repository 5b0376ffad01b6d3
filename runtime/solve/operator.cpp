#include "lancet/runtime/solve/operator.hpp"

#include <string>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/solve/block_loop.hpp"
#include "lancet/runtime/solve/matrix_free.hpp"
#include "lancet/runtime/solve/row_operators.hpp"

namespace lancet::runtime {

using kernels::ScatterStrategy;

std::string_view to_string(OperatorKind kind) noexcept {
    switch (kind) {
        case OperatorKind::matrix_free:
            return "matrix-free";
        case OperatorKind::edge_blocks:
            return "edge-blocks";
        default:
            return "block-rows";
    }
}

OperatorKind operator_kind_from_string(std::string_view name) {
    for (const OperatorKind kind : {OperatorKind::matrix_free, OperatorKind::edge_blocks, OperatorKind::block_rows}) {
        if (to_string(kind) == name) return kind;
    }
    throw Error("unknown operator '" + std::string(name) + "'; expected matrix-free, edge-blocks or block-rows");
}

template <class Real>
Operator<Real>::Operator(ElasticElements<Real>& elements, std::vector<double> nodal_mass)
    : elements_(&elements),
      nodal_mass_(std::move(nodal_mass)),
      scaled_mass_(nodal_mass_.begin(), nodal_mass_.end()),
      quadratic_(static_cast<std::size_t>(elements.numbering().blocks())) {}

template <class Real>
void Operator<Real>::set_plan(const kernels::ScatterPlan& plan) {
    plan_ = &plan;
    y_.assign(static_cast<std::size_t>(plan.buffer_size()) * 4, Real(0));
}

template <class Real>
void Operator<Real>::set_factors(const Factors& factors) {
    if (factors.mass == factors_.mass && factors.stiffness == factors_.stiffness) return;
    factors_ = factors;
    for (std::size_t node = 0; node < nodal_mass_.size(); ++node) {
        scaled_mass_[node] = static_cast<Real>(factors.mass * nodal_mass_[node]);
    }
}

template <class Real>
bool Operator<Real>::change(const LayoutChange& change) {
    for (const LayoutChange::NodalMass& changed : change.masses) {
        nodal_mass_[changed.node] = changed.mass;
        scaled_mass_[changed.node] = static_cast<Real>(factors_.mass * changed.mass);
    }
    return true;
}

template <class Real>
double Operator<Real>::product(Scheduler& scheduler, const Real* z) {
    const bool exclusive = plan_->strategy() == ScatterStrategy::node_gather;
    const kernels::OpenArguments<Real> open{.block_begin = numbering().block_begin.data(),
                                            .slot_begin = plan_->slot_begin().data(),
                                            .slot_end = plan_->slot_end().data(),
                                            .mass = scaled_mass_.data(),
                                            .z = z,
                                            .y = y_.data(),
                                            .quadratic = quadratic_.data(),
                                            .clear_slots = !exclusive};
    const kernels::ProductArguments<Real> product{
        .z = z, .y = y_.data(), .quadratic = quadratic_.data(), .exclusive_slots = exclusive};
    const bool open_first = plan_->strategy() == ScatterStrategy::coloring;
    if (open_first) {
        for_each_awake_block(scheduler, numbering(), [&](int block) { kernels().matrix.open(open, block); });
    }
    for_each_color(scheduler, numbering(), *plan_, [&](int block) {
        if (!open_first) kernels().matrix.open(open, block);
        add_product(product, block);
    });
    return sum_over_awake_blocks(numbering(), quadratic_);
}

template <class Real>
void Operator<Real>::merge(int block) {
    kernels().matrix.merge(plan_->merge_begin().data(), plan_->merges().data(), y_.data(), block);
}

template <class Real>
std::size_t Operator<Real>::bytes() const noexcept {
    using kernels::heap_bytes;
    return heap_bytes(nodal_mass_) + heap_bytes(scaled_mass_) + heap_bytes(y_) + heap_bytes(quadratic_);
}

template <class Real>
std::unique_ptr<Operator<Real>> make_operator(OperatorKind kind, ElasticElements<Real>& elements,
                                              const OperatorDefinition& definition) {
    if (elements.layout() != gradient_layout(kind, elements.law())) {
        throw Error("operator " + std::string(to_string(kind)) + ": the elements are not in the layout that it reads");
    }
    if (kind == OperatorKind::matrix_free) return std::make_unique<MatrixFree<Real>>(elements, definition);
    return std::make_unique<RowOperator<Real>>(kind, elements, definition);
}

template class Operator<float>;
template class Operator<double>;
template std::unique_ptr<Operator<float>> make_operator<float>(OperatorKind, ElasticElements<float>&,
                                                               const OperatorDefinition&);
template std::unique_ptr<Operator<double>> make_operator<double>(OperatorKind, ElasticElements<double>&,
                                                                 const OperatorDefinition&);

}  // namespace lancet::runtime
