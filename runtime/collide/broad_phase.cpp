#include "lancet/runtime/collide/broad_phase.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "lancet/kernels/error.hpp"
#include "lancet/kernels/layout/aligned_vector.hpp"
#include "lancet/runtime/collide/broad_phase_kinds.hpp"

namespace lancet::runtime {
namespace {

constexpr std::array all_kinds{BroadPhaseKind::aabb_tree, BroadPhaseKind::sphere_tree, BroadPhaseKind::spatial_hash,
                               BroadPhaseKind::octree, BroadPhaseKind::brute_force};

/// Queries of a block: some tens of microseconds of work. It does not depend on the threads.
constexpr std::size_t queries_per_block = 256;

void copy_valid(std::span<const Box> from, std::span<Box> to) {
    std::ranges::transform(from, to.begin(), valid_or_empty);
}

}  // namespace

std::span<const BroadPhaseKind> broad_phase_kinds() noexcept {
    return all_kinds;
}

std::string_view to_string(BroadPhaseKind kind) noexcept {
    switch (kind) {
        case BroadPhaseKind::aabb_tree:
            return "aabb-tree";
        case BroadPhaseKind::sphere_tree:
            return "sphere-tree";
        case BroadPhaseKind::spatial_hash:
            return "spatial-hash";
        case BroadPhaseKind::octree:
            return "octree";
        case BroadPhaseKind::brute_force:
            return "brute-force";
    }
    return "unknown";
}

BroadPhaseKind broad_phase_from_string(std::string_view text) {
    std::string list;
    for (const BroadPhaseKind kind : all_kinds) {
        if (to_string(kind) == text) return kind;
        if (!list.empty()) list += ", ";
        list += to_string(kind);
    }
    throw Error("there is no broad phase '" + std::string(text) + "'; expected one of: " + list);
}

std::unique_ptr<BroadPhase> make_broad_phase(BroadPhaseKind kind) {
    switch (kind) {
        case BroadPhaseKind::aabb_tree:
            return make_aabb_tree();
        case BroadPhaseKind::sphere_tree:
            return make_sphere_tree();
        case BroadPhaseKind::spatial_hash:
            return make_spatial_hash();
        case BroadPhaseKind::octree:
            return make_octree();
        case BroadPhaseKind::brute_force:
            return make_brute_force();
    }
    throw Error("there is no broad phase with number " + std::to_string(static_cast<int>(kind)));
}

void BroadPhase::build(std::span<const Box> boxes) {
    boxes_.resize(boxes.size());
    copy_valid(boxes, boxes_);
    build_index();
}

void BroadPhase::refit(std::span<const Box> boxes) {
    if (boxes.size() != boxes_.size()) {
        throw Error("refit: " + std::to_string(boxes.size()) + " boxes; expected " + std::to_string(boxes_.size()) +
                    ", as many as it was built with");
    }
    copy_valid(boxes, boxes_);
    if (refit_index()) ++rebuilds_;
}

void BroadPhase::collect_sorted(const Box& box, std::int32_t first, std::vector<std::int32_t>& found) const {
    found.clear();
    collect(box, first, found);
    std::ranges::sort(found);
    found.erase(std::ranges::unique(found).begin(), found.end());
}

void BroadPhase::query(const Box& box, std::vector<std::int32_t>& found) const {
    collect_sorted(valid_or_empty(box), 0, found);
}

template <class Query>
void BroadPhase::gather(Scheduler& scheduler, std::size_t queries, std::vector<BoxPair>& found, const Query& query) {
    const std::size_t blocks = (queries + queries_per_block - 1) / queries_per_block;
    if (blocks_.size() < blocks) blocks_.resize(blocks);
    scheduler.for_each_block(static_cast<int>(blocks), [&](int block) {
        BlockResult& result = blocks_[static_cast<std::size_t>(block)];
        result.pairs.clear();
        const std::size_t begin = static_cast<std::size_t>(block) * queries_per_block;
        const std::size_t end = std::min(begin + queries_per_block, queries);
        for (std::size_t i = begin; i < end; ++i) query(static_cast<std::int32_t>(i), result);
    });
    found.clear();
    for (std::size_t block = 0; block < blocks; ++block) {
        found.insert(found.end(), blocks_[block].pairs.begin(), blocks_[block].pairs.end());
    }
}

void BroadPhase::pairs(Scheduler& scheduler, std::span<const Box> others, std::vector<BoxPair>& found) {
    gather(scheduler, others.size(), found, [&](std::int32_t other, BlockResult& result) {
        collect_sorted(valid_or_empty(others[static_cast<std::size_t>(other)]), 0, result.numbers);
        for (const std::int32_t own : result.numbers) result.pairs.push_back({own, other});
    });
}

void BroadPhase::self_pairs(Scheduler& scheduler, std::vector<BoxPair>& found) {
    gather(scheduler, boxes_.size(), found, [&](std::int32_t own, BlockResult& result) {
        collect_sorted(boxes_[static_cast<std::size_t>(own)], own + 1, result.numbers);
        for (const std::int32_t other : result.numbers) result.pairs.push_back({own, other});
    });
}

std::size_t BroadPhase::bytes() const noexcept {
    using kernels::heap_bytes;
    std::size_t sum = heap_bytes(boxes_) + heap_bytes(blocks_) + index_bytes();
    for (const BlockResult& block : blocks_) sum += heap_bytes(block.numbers) + heap_bytes(block.pairs);
    return sum;
}

}  // namespace lancet::runtime
