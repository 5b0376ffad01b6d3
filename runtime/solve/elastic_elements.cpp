#include "lancet/runtime/solve/elastic_elements.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/solve/block_loop.hpp"

namespace lancet::runtime {

using kernels::GradientLayout;
using kernels::ScatterStrategy;

namespace {

std::size_t numbers_per_element(GradientLayout layout) {
    switch (layout) {
        case GradientLayout::batches:
            return 9;
        case GradientLayout::corners:
            return 16;
        default:
            return kernels::element_block_entries;
    }
}

}  // namespace

template <class Real>
ElasticElements<Real>::ElasticElements(const kernels::KernelSet<Real>& kernels, kernels::ElementBatches<Real> batches,
                                       const kernels::NodeNumbering& numbering, GradientLayout layout,
                                       const RotationSettings& rotation, const ElasticLaw& law)
    : kernels_(&kernels),
      numbering_(&numbering),
      batches_(std::move(batches)),
      layout_(layout),
      rotation_(rotation),
      law_(law),
      quaternion_(static_cast<std::size_t>(batches_.slots()) * 4),
      // One batch of zeros behind the last is what incidences of nothing read.
      rotated_((static_cast<std::size_t>(batches_.slots()) + static_cast<std::size_t>(batches_.width)) *
               numbers_per_element(layout)),
      force_(static_cast<std::size_t>(batches_.scatter.buffer_size()) * 4),
      energy_(static_cast<std::size_t>(numbering.blocks())) {
    kernels::require_tangent(law.model, law.tangent);
    if (law.is_rotated() == (layout == GradientLayout::element_blocks)) {
        throw Error("elements: the layout does not suit the law; see gradient_layout");
    }
}

template <class Real>
kernels::HyperelasticArguments<Real> ElasticElements<Real>::hyperelastic_arguments(const double* positions,
                                                                                   const Wanted& wanted) {
    return {.block_batch_begin = batches_.block_batch_begin.data(),
            .nodes = batches_.nodes.data(),
            .targets = batches_.targets.data(),
            .rest = batches_.rest.data(),
            .positions = positions,
            .start = wanted.start,
            .quaternion = quaternion_.data(),
            .force = wanted.force ? force_.data() : nullptr,
            .energy = wanted.energy ? energy_.data() : nullptr,
            .element_blocks = rotated_.data(),
            .model = law_.model,
            .tangent = law_.tangent,
            .rotation_steps = rotation_.steps,
            .exclusive_slots = batches_.scatter.strategy() == ScatterStrategy::node_gather};
}

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
kernels::TetrahedronArguments<Real> ElasticElements<Real>::arguments_at_rest(const double* positions) {
    auto at_rest = arguments(positions, {.rotation = true, .force = false, .energy = false});
    at_rest.method = kernels::RotationMethod::quaternion;
    at_rest.rotation_steps = 0;
    return at_rest;
}

template <class Real>
void ElasticElements<Real>::reset(Scheduler& scheduler, const double* positions) {
    const auto width = static_cast<std::size_t>(batches_.width);
    for (std::size_t i = 0; i < quaternion_.size(); ++i) quaternion_[i] = (i / width) % 4 == 0 ? Real(1) : Real(0);
    if (!law_.is_rotated()) {
        evaluate(scheduler, positions, {.rotation = true, .force = false});
        return;
    }
    const auto gradients_at_rest = arguments_at_rest(positions);
    scheduler.for_each_block(numbering_->blocks(),
                             [&](int block) { kernels_->tetrahedron.elastic(gradients_at_rest, block); });
}

template <class Real>
bool ElasticElements<Real>::change(std::int32_t& slot, const kernels::ChangedElement* element, std::int32_t like) {
    const auto block_of = [&](std::int32_t of_slot) {
        const auto& begin = batches_.block_batch_begin;
        return static_cast<int>(std::upper_bound(begin.begin(), begin.end(), of_slot / batches_.width) -
                                begin.begin()) -
               1;
    };
    if (element == nullptr) {
        clear_slot(batches_, slot);
        return true;
    }
    if (slot < 0) {
        slot = take_slot(batches_, *element);
        if (slot < 0) return false;
        const auto width = static_cast<std::size_t>(batches_.width), to = static_cast<std::size_t>(slot),
                   from = static_cast<std::size_t>(like);
        for (std::size_t k = 0; k < 4; ++k) {
            quaternion_[(to / width * 4 + k) * width + to % width] =
                quaternion_[(from / width * 4 + k) * width + from % width];
        }
    }
    changed_blocks_.push_back(block_of(slot));
    return set_element(batches_, *numbering_, slot, *element);
}

template <class Real>
void ElasticElements<Real>::finish_changes(const double* rest_positions) {
    batches_.scatter.finish_changes();
    std::sort(changed_blocks_.begin(), changed_blocks_.end());
    changed_blocks_.erase(std::unique(changed_blocks_.begin(), changed_blocks_.end()), changed_blocks_.end());
    if (watch_) {
        for (const int block : changed_blocks_) watch_->change(batches_, *numbering_, block);
    }
    if (law_.model == ElementModel::linear) {
        const auto at_rest = arguments_at_rest(rest_positions);
        for (const int block : changed_blocks_) kernels_->tetrahedron.elastic(at_rest, block);
    }
    changed_blocks_.clear();
}

template <class Real>
template <class Add>
void ElasticElements<Real>::scatter(Scheduler& scheduler, bool is_wanted, const Add& add) {
    const kernels::ScatterPlan& plan = batches_.scatter;
    const kernels::OpenArguments<Real> open{.block_begin = numbering_->block_begin.data(),
                                            .slot_begin = plan.slot_begin().data(),
                                            .slot_end = plan.slot_end().data(),
                                            .mass = nullptr,
                                            .z = nullptr,
                                            .y = force_.data(),
                                            .quadratic = nullptr,
                                            .clear_slots = plan.strategy() != ScatterStrategy::node_gather};
    const bool open_first = plan.strategy() == ScatterStrategy::coloring && is_wanted;
    if (open_first) {
        for_each_awake_block(scheduler, *numbering_, [&](int block) { kernels_->matrix.open(open, block); });
    }
    for_each_color(scheduler, *numbering_, plan, [&](int block) {
        if (is_wanted && !open_first) kernels_->matrix.open(open, block);
        add(block);
    });
}

template <class Real>
double ElasticElements<Real>::evaluate(Scheduler& scheduler, const double* positions, const Wanted& wanted) {
    if (!law_.is_rotated()) {
        const auto call = hyperelastic_arguments(positions, wanted);
        const bool wants_tangent = wanted.rotation && wanted.keep_gradients;
        scatter(scheduler, wanted.force, [&](int block) {
            if (wanted.force || wanted.energy) kernels_->hyperelastic.evaluate(call, block);
            if (wants_tangent) kernels_->hyperelastic.tangent(call, block);
        });
        return wanted.energy ? sum_over_awake_blocks(*numbering_, energy_) : 0.0;
    }
    const auto call = arguments(positions, wanted);
    if (watch_ && wanted.rotation && wanted.keep_gradients) {
        watch(scheduler, positions, wanted.rotation_bound);
        auto kept = wanted;
        kept.rotation = false;
        const auto call_kept = arguments(positions, kept);
        scatter(scheduler, wanted.force, [&](int block) {
            const bool has_turned = has_turned_[static_cast<std::size_t>(block)] != 0;
            kernels_->tetrahedron.elastic(has_turned ? call : call_kept, block);
        });
    } else {
        scatter(scheduler, wanted.force, [&](int block) { kernels_->tetrahedron.elastic(call, block); });
    }
    return wanted.energy ? sum_over_awake_blocks(*numbering_, energy_) : 0.0;
}

template <class Real>
void ElasticElements<Real>::watch_deformation() {
    if (watch_ || !law_.is_rotated()) return;
    watch_.emplace(batches_, *numbering_);
    stale_blocks_.assign(static_cast<std::size_t>(numbering_->blocks()), 1);
    has_turned_ = stale_blocks_;
}

template <class Real>
void ElasticElements<Real>::watch(Scheduler& scheduler, const double* positions, double bound) {
    if (numbering_->sleeping.are_left_out) std::ranges::fill(has_turned_, std::uint8_t{0});
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        has_turned_[static_cast<std::size_t>(block)] = watch_->has_changed(block, positions, bound) ? 1 : 0;
    });
    for (int block = 0; block < numbering_->blocks(); ++block) {
        if (has_turned_[static_cast<std::size_t>(block)] == 0) continue;
        for (const int touched : watch_->touched_blocks(block)) stale_blocks_[static_cast<std::size_t>(touched)] = 1;
        // Rows of the room may be of any node.
        if (numbering_->has_room()) stale_blocks_.back() = 1;
    }
}

template <class Real>
void ElasticElements<Real>::save_watch(std::vector<double>& numbers) const {
    if (watch_) watch_->save(numbers);
}

template <class Real>
void ElasticElements<Real>::restore_watch(std::span<const double>& numbers) {
    if (!watch_) return;
    watch_->restore(numbers);
    std::ranges::fill(stale_blocks_, std::uint8_t{1});
}

template <class Real>
void ElasticElements<Real>::invert_diagonal(Scheduler& scheduler, const DiagonalWanted& wanted,
                                            std::span<Real> inverse) {
    kernels::ElementDiagonalArguments<Real> shares{
        .block_batch_begin = batches_.block_batch_begin.data(),
        .targets = batches_.targets.data(),
        .rest = batches_.rest.data(),
        .rotated = rotated_.data(),
        .pair_mass = wanted.has_consistent_mass ? batches_.pair_mass.data() : nullptr,
        .buffer = force_.data(),
        .stiffness_factor = static_cast<Real>(wanted.stiffness_factor),
        .mass_factor = static_cast<Real>(wanted.mass_factor),
        .layout = layout_,
        .part = kernels::DiagonalPart::axial,
        .exclusive_slots = batches_.scatter.strategy() == ScatterStrategy::node_gather};
    const kernels::InvertDiagonalArguments<Real> inversion{.block_begin = numbering_->block_begin.data(),
                                                           .buffer = force_.data(),
                                                           .mass = wanted.nodal_mass,
                                                           .inverse = inverse.data(),
                                                           .blocks = wanted.blocks};
    const auto add_shares = [&](int block) { kernels_->diagonal.scatter(shares, block); };
    scatter(scheduler, true, add_shares);
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        merge_force(block);
        kernels_->diagonal.keep(inversion, block);
    });
    if (wanted.blocks) {
        shares.part = kernels::DiagonalPart::mixed;
        scatter(scheduler, true, add_shares);
    }
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        if (wanted.blocks) merge_force(block);
        kernels_->diagonal.invert(inversion, block);
        forget_sleeping(inverse, block);
    });
}

/// What sleeps beside others has not got the shares of blocks that were left out: it gets no correction.
template <class Real>
void ElasticElements<Real>::forget_sleeping(std::span<Real> inverse, int block) const {
    if (!numbering_->sleeping.are_left_out) return;
    const auto width = static_cast<std::size_t>(batches_.width);
    for (std::int32_t node = numbering_->block_begin[block]; node < numbering_->block_begin[block + 1]; ++node) {
        if (!numbering_->sleeping.has(node)) continue;
        const auto at = static_cast<std::size_t>(node);
        for (std::size_t k = 0; k < 6; ++k) inverse[(at / width * 6 + k) * width + at % width] = Real(0);
    }
}

template <class Real>
kernels::SleepingNodes ElasticElements<Real>::sleeping(std::vector<std::uint8_t> nodes) const {
    kernels::SleepingNodes sleeping{.nodes = std::move(nodes)};
    const auto blocks = static_cast<std::size_t>(numbering_->blocks());
    const auto first_blocks = static_cast<std::size_t>(numbering_->first_blocks());
    const auto width = static_cast<std::size_t>(batches_.width);
    sleeping.blocks.assign(blocks, 0);
    for (std::size_t block = 0; block < blocks; ++block) {
        bool sleeps = block < first_blocks;
        for (std::int32_t node = numbering_->block_begin[block]; node < numbering_->block_begin[block + 1]; ++node) {
            sleeps = sleeps && (numbering_->user_of_internal[node] < 0 || sleeping.has(node));
        }
        const auto end = static_cast<std::size_t>(batches_.block_batch_begin[block + 1]);
        for (auto batch = static_cast<std::size_t>(batches_.block_batch_begin[block]); batch < end; ++batch) {
            const Real* weights = &batches_.rest[(batch * kernels::ElementBatches<Real>::rest_entries + 9) * width];
            for (std::size_t lane = 0; lane < width; ++lane) {
                if (weights[lane] == 0) continue;  // padding
                int asleep = 0;
                for (std::size_t corner = 0; corner < 4; ++corner) {
                    asleep += sleeping.has(batches_.nodes[(batch * 4 + corner) * width + lane] / 4) ? 1 : 0;
                }
                if (asleep != 0 && asleep != 4) {
                    throw Error("sleep: an element has " + std::to_string(asleep) +
                                " nodes that are asleep; expected all four or none");
                }
                sleeps = sleeps && asleep == 4;
            }
        }
        sleeping.blocks[block] = sleeps ? 1 : 0;
        if (!sleeps) sleeping.awake_blocks.push_back(static_cast<std::int32_t>(block));
    }
    return sleeping;
}

template <class Real>
void ElasticElements<Real>::merge_force(int block) {
    const kernels::ScatterPlan& plan = batches_.scatter;
    kernels_->matrix.merge(plan.merge_begin().data(), plan.merges().data(), force_.data(), block);
}

template <class Real>
std::size_t ElasticElements<Real>::bytes() const noexcept {
    using kernels::heap_bytes;
    return batches_.bytes() + (watch_ ? watch_->bytes() : 0) + heap_bytes(quaternion_) + heap_bytes(rotated_) +
           heap_bytes(force_) + heap_bytes(energy_);
}

template class ElasticElements<float>;
template class ElasticElements<double>;

}  // namespace lancet::runtime
