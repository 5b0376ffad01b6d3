#include "lancet/kernels/layout/scatter_plan.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <tuple>

#include "lancet/kernels/error.hpp"
#include "lancet/kernels/layout/aligned_vector.hpp"

namespace lancet::kernels {

std::string_view to_string(ScatterStrategy strategy) noexcept {
    switch (strategy) {
        case ScatterStrategy::private_copies:
            return "private-copies";
        case ScatterStrategy::coloring:
            return "coloring";
        default:
            return "node-gather";
    }
}

ScatterStrategy scatter_strategy_from_string(std::string_view name) {
    for (const auto strategy :
         {ScatterStrategy::private_copies, ScatterStrategy::coloring, ScatterStrategy::node_gather}) {
        if (to_string(strategy) == name) return strategy;
    }
    throw Error("unknown scatter strategy '" + std::string(name) +
                "'; expected private-copies, coloring or node-gather");
}

ScatterPlan::ScatterPlan(ScatterStrategy strategy, const NodeNumbering& numbering)
    : strategy_(strategy),
      numbering_(&numbering),
      next_slot_(numbering.node_count),
      slot_begin_(1, numbering.node_count),
      inbox_(static_cast<std::size_t>(numbering.blocks())),
      foreign_(static_cast<std::size_t>(numbering.blocks())) {}

void ScatterPlan::open(int block) {
    while (open_block_ < block) {
        if (open_block_ >= 0) close();
        ++open_block_;
        copies_.clear();
        new_slot();  // the slot that nobody reads is the first of the block
    }
}

void ScatterPlan::close() {
    slot_end_.push_back(next_slot_);
    if (numbering_->has_room()) {
        // Foreign nodes that come later: for a block those of the room beside it, for the room all that border on it.
        const std::int32_t spare = numbering_->free_count - numbering_->spare_begin;
        const std::int32_t own = numbering_->block_begin[open_block_ + 1] - numbering_->block_begin[open_block_];
        next_slot_ += open_block_ < numbering_->first_blocks() ? std::min(spare, own / 2 + 32) : 4 * spare + 64;
    }
    slot_begin_.push_back(next_slot_);
}

std::int32_t ScatterPlan::unused(int block) {
    open(block);
    return slot_begin_.back();
}

std::int32_t ScatterPlan::target(int block, std::int32_t node) {
    open(block);
    if (!numbering_->is_free(node)) return unused(block);
    const int owner = numbering_->block_of(node);
    if (strategy_ == ScatterStrategy::node_gather) {
        const std::int32_t slot = new_slot();
        inbox_[static_cast<std::size_t>(owner)].push_back({node, slot});
        return slot;
    }
    if (owner == block) return node;
    if (strategy_ == ScatterStrategy::coloring) {
        foreign_[static_cast<std::size_t>(block)].push_back(node);
        return node;
    }
    const auto [copy, is_new] = copies_.try_emplace(node, next_slot_);
    if (is_new) {
        new_slot();
        inbox_[static_cast<std::size_t>(owner)].push_back({node, copy->second});
    }
    return copy->second;
}

void ScatterPlan::finish() {
    const int blocks = numbering_->blocks();
    if (blocks > 0) {
        open(blocks - 1);
        close();
    } else {
        slot_begin_.push_back(next_slot_);
    }
    copies_ = {};

    merge_begin_.push_back(0);
    for (std::vector<Merge>& inbox : inbox_) {
        std::sort(inbox.begin(), inbox.end(),
                  [](const Merge& a, const Merge& b) { return std::tie(a.node, a.slot) < std::tie(b.node, b.slot); });
        merges_.insert(merges_.end(), inbox.begin(), inbox.end());
        merge_begin_.push_back(static_cast<std::int32_t>(merges_.size()));
    }
    merges_.shrink_to_fit();
    inbox_ = {};

    if (strategy_ != ScatterStrategy::coloring) {
        colors_.emplace_back();
        for (std::int32_t block = 0; block < blocks; ++block) colors_.back().push_back(block);
        foreign_ = {};
        return;
    }
    // Two blocks conflict if one writes to a node of the other or both write to the same foreign node.
    std::unordered_map<std::int32_t, std::vector<std::int32_t>> writers_of_node;
    std::vector<std::vector<std::int32_t>> conflicts(static_cast<std::size_t>(blocks));
    for (std::int32_t block = 0; block < blocks; ++block) {
        std::vector<std::int32_t>& nodes = foreign_[static_cast<std::size_t>(block)];
        std::sort(nodes.begin(), nodes.end());
        nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
        for (const std::int32_t node : nodes) {
            std::vector<std::int32_t>& writers = writers_of_node[node];
            if (writers.empty()) writers.push_back(numbering_->block_of(node));
            for (const std::int32_t other : writers) {
                conflicts[static_cast<std::size_t>(block)].push_back(other);
                conflicts[static_cast<std::size_t>(other)].push_back(block);
            }
            writers.push_back(block);
        }
    }
    std::vector<int> color_of(static_cast<std::size_t>(blocks), -1);
    for (std::int32_t block = 0; block < blocks; ++block) {
        std::vector<bool> taken(colors_.size() + 1, false);
        for (const std::int32_t other : conflicts[static_cast<std::size_t>(block)]) {
            if (color_of[static_cast<std::size_t>(other)] >= 0) {
                taken[static_cast<std::size_t>(color_of[static_cast<std::size_t>(other)])] = true;
            }
        }
        const auto color = static_cast<std::size_t>(std::find(taken.begin(), taken.end(), false) - taken.begin());
        if (color == colors_.size()) colors_.emplace_back();
        colors_[color].push_back(block);
        color_of[static_cast<std::size_t>(block)] = static_cast<int>(color);
    }
    foreign_ = {};
}

std::int32_t ScatterPlan::changed_target(const NodeNumbering& numbering, int block, std::int32_t node) {
    const auto of_block = static_cast<std::size_t>(block);
    if (!numbering.is_free(node)) return unused_slot(block);
    const auto owner = static_cast<std::size_t>(numbering.block_of(node));
    if (owner == of_block) return node;
    const Merge first{node, slot_begin_[of_block]};
    const auto is_before = [](const Merge& a, const Merge& b) {
        return std::tie(a.node, a.slot) < std::tie(b.node, b.slot);
    };
    const auto is_found = [&](auto place, auto end) {
        return place != end && place->node == node && place->slot < slot_begin_[of_block + 1];
    };
    const auto end = merges_.begin() + merge_begin_[owner + 1];
    const auto known = std::lower_bound(merges_.begin() + merge_begin_[owner], end, first, is_before);
    if (is_found(known, end)) return known->slot;
    changes_.resize(merge_begin_.size() - 1);
    std::vector<Merge>& changes = changes_[owner];
    const auto change = std::lower_bound(changes.begin(), changes.end(), first, is_before);
    if (is_found(change, changes.end())) return change->slot;
    if (slot_end_[of_block] == slot_begin_[of_block + 1]) return -1;
    const std::int32_t slot = slot_end_[of_block]++;
    changes.insert(change, {node, slot});
    return slot;
}

void ScatterPlan::finish_changes() {
    if (std::all_of(changes_.begin(), changes_.end(), [](const auto& changes) { return changes.empty(); })) return;
    std::vector<Merge> merges;
    std::vector<std::int32_t> begin{0};
    for (std::size_t owner = 0; owner < changes_.size(); ++owner) {
        std::merge(merges_.begin() + merge_begin_[owner], merges_.begin() + merge_begin_[owner + 1],
                   changes_[owner].begin(), changes_[owner].end(), std::back_inserter(merges),
                   [](const Merge& a, const Merge& b) { return std::tie(a.node, a.slot) < std::tie(b.node, b.slot); });
        begin.push_back(static_cast<std::int32_t>(merges.size()));
        changes_[owner].clear();
    }
    merges_ = std::move(merges);
    merge_begin_ = std::move(begin);
}

std::size_t ScatterPlan::bytes() const noexcept {
    return heap_bytes(slot_begin_) + heap_bytes(merge_begin_) + heap_bytes(merges_) + heap_bytes(slot_end_);
}

}  // namespace lancet::kernels
