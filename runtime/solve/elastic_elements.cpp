#include "lancet/runtime/solve/elastic_elements.hpp"

#include "lancet/runtime/schedule/ordered_sum.hpp"
#include "lancet/runtime/solve/block_loop.hpp"

namespace lancet::runtime {

using kernels::GradientLayout;
using kernels::ScatterStrategy;

template <class Real>
ElasticElements<Real>::ElasticElements(const kernels::KernelSet<Real>& kernels, kernels::ElementBatches<Real> batches,
                                       const kernels::NodeNumbering& numbering, GradientLayout layout,
                                       const RotationSettings& rotation)
    : kernels_(&kernels),
      numbering_(&numbering),
      batches_(std::move(batches)),
      layout_(layout),
      rotation_(rotation),
      quaternion_(static_cast<std::size_t>(batches_.slots()) * 4),
      // One batch of zeros behind the last is what incidences of nothing read.
      rotated_((static_cast<std::size_t>(batches_.slots()) + static_cast<std::size_t>(batches_.width)) *
               (layout == GradientLayout::batches ? 9 : 16)),
      force_(static_cast<std::size_t>(batches_.scatter.buffer_size()) * 4),
      energy_(static_cast<std::size_t>(numbering.blocks())) {}

template <class Real>
kernels::TetrahedronArguments<Real> ElasticElements<Real>::arguments(const double* positions, const Wanted& wanted) {
    return {.block_batch_begin = batches_.block_batch_begin.data(),
            .nodes = batches_.nodes.data(),
            .targets = batches_.targets.data(),
            .rest = batches_.rest.data(),
            .positions = positions,
            .quaternion = quaternion_.data(),
            .rotated = wanted.rotation && !wanted.keep_gradients ? nullptr : rotated_.data(),
            .force = wanted.force ? force_.data() : nullptr,
            .energy = wanted.energy ? energy_.data() : nullptr,
            .layout = layout_,
            .method = rotation_.method,
            .rotation_steps = rotation_.steps,
            .update_rotation = wanted.rotation,
            .exclusive_slots = batches_.scatter.strategy() == ScatterStrategy::node_gather};
}

template <class Real>
void ElasticElements<Real>::reset(Scheduler& scheduler, const double* positions) {
    const auto width = static_cast<std::size_t>(batches_.width);
    for (std::size_t i = 0; i < quaternion_.size(); ++i) quaternion_[i] = (i / width) % 4 == 0 ? Real(1) : Real(0);
    auto gradients_at_rest = arguments(positions, {.rotation = true, .force = false, .energy = false});
    gradients_at_rest.method = kernels::RotationMethod::quaternion;
    gradients_at_rest.rotation_steps = 0;
    scheduler.for_each_block(numbering_->blocks(),
                             [&](int block) { kernels_->tetrahedron.elastic(gradients_at_rest, block); });
}

template <class Real>
double ElasticElements<Real>::evaluate(Scheduler& scheduler, const double* positions, const Wanted& wanted) {
    const auto call = arguments(positions, wanted);
    const kernels::ScatterPlan& plan = batches_.scatter;
    const kernels::OpenArguments<Real> open{.block_begin = numbering_->block_begin.data(),
                                            .slot_begin = plan.slot_begin().data(),
                                            .mass = nullptr,
                                            .z = nullptr,
                                            .y = force_.data(),
                                            .quadratic = nullptr,
                                            .clear_slots = plan.strategy() != ScatterStrategy::node_gather};
    const bool open_first = plan.strategy() == ScatterStrategy::coloring && wanted.force;
    if (open_first) {
        scheduler.for_each_block(numbering_->blocks(), [&](int block) { kernels_->matrix.open(open, block); });
    }
    for_each_color(scheduler, plan, [&](int block) {
        if (wanted.force && !open_first) kernels_->matrix.open(open, block);
        kernels_->tetrahedron.elastic(call, block);
    });
    return wanted.energy ? sum_in_order(std::span<const double>(energy_)) : 0.0;
}

template <class Real>
void ElasticElements<Real>::merge_force(int block) {
    const kernels::ScatterPlan& plan = batches_.scatter;
    kernels_->matrix.merge(plan.merge_begin().data(), plan.merges().data(), force_.data(), block);
}

template <class Real>
std::size_t ElasticElements<Real>::bytes() const noexcept {
    using kernels::heap_bytes;
    return batches_.bytes() + heap_bytes(quaternion_) + heap_bytes(rotated_) + heap_bytes(force_) + heap_bytes(energy_);
}

template class ElasticElements<float>;
template class ElasticElements<double>;

}  // namespace lancet::runtime
