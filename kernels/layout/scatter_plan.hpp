#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "lancet/kernels/layout/node_numbering.hpp"

namespace lancet::kernels {

/// How the results of elements or edges reach the nodes without two threads writing to one.
enum class ScatterStrategy {
    private_copies,  ///< a block adds to its own nodes and to private copies of foreign ones, merged in block order
    coloring,        ///< blocks that share a node have different colors; colors run one after the other
    node_gather      ///< every contribution has a slot of its own; each node then sums its slots
};

std::string_view to_string(ScatterStrategy strategy) noexcept;
ScatterStrategy scatter_strategy_from_string(std::string_view name);

/// Where the contributions of each block go: indices into a buffer that starts with all nodes of the numbering and
/// goes on with slots. Build: call `target` for the contributions of block 0, 1, ... in order, then `finish`.
///
/// The sum at a node has a fixed order for each strategy, whatever the scheduler and the number of threads.
class ScatterPlan {
  public:
    /// A slot to be added to a node of the block that owns it.
    struct Merge {
        std::int32_t node;
        std::int32_t slot;
    };

    ScatterPlan() = default;
    ScatterPlan(ScatterStrategy strategy, const NodeNumbering& numbering);

    /// The place of one contribution of `block` to `node`. Contributions to fixed nodes go to a slot that nobody reads.
    std::int32_t target(int block, std::int32_t node);
    /// The place of padding: a slot of the block that nobody reads.
    std::int32_t unused(int block);
    void finish();

    /// The same for a plan that has been finished, with room (see NodeNumbering) and private copies. -1: there is no
    /// room. Before the plan is used, call finish_changes.
    std::int32_t changed_target(const NodeNumbering& numbering, int block, std::int32_t node);
    std::int32_t unused_slot(int block) const noexcept { return slot_begin_[static_cast<std::size_t>(block)]; }
    void finish_changes();

    ScatterStrategy strategy() const noexcept { return strategy_; }
    /// Nodes and slots of the buffer.
    std::int32_t buffer_size() const noexcept { return next_slot_; }
    /// The slots of a block are [slot_begin[block], slot_begin[block + 1]).
    const std::vector<std::int32_t>& slot_begin() const noexcept { return slot_begin_; }
    /// The end of the slots that are in use, [block]: what is behind is room, and nobody writes or reads it.
    const std::vector<std::int32_t>& slot_end() const noexcept { return slot_end_; }
    /// What block b has to add to its nodes: merges[merge_begin[b], merge_begin[b + 1]), by node, then slot.
    const std::vector<std::int32_t>& merge_begin() const noexcept { return merge_begin_; }
    const std::vector<Merge>& merges() const noexcept { return merges_; }
    /// For strategy coloring: the blocks of each color; one color with all blocks otherwise.
    const std::vector<std::vector<std::int32_t>>& colors() const noexcept { return colors_; }
    std::size_t bytes() const noexcept;

  private:
    void open(int block);
    void close();
    std::int32_t new_slot() { return next_slot_++; }

    ScatterStrategy strategy_ = ScatterStrategy::private_copies;
    const NodeNumbering* numbering_ = nullptr;  // while building
    int open_block_ = -1;
    std::int32_t next_slot_ = 0;
    std::unordered_map<std::int32_t, std::int32_t> copies_;  // of the open block: foreign node -> slot
    std::vector<std::int32_t> slot_begin_;
    std::vector<std::vector<Merge>> inbox_;
    std::vector<std::vector<std::int32_t>> foreign_;  // foreign nodes that each block writes to (coloring)
    std::vector<std::int32_t> merge_begin_;
    std::vector<Merge> merges_;
    std::vector<std::vector<std::int32_t>> colors_;
    std::vector<std::int32_t> slot_end_;       ///< the end of the slots of each block that are in use
    std::vector<std::vector<Merge>> changes_;  ///< new merges of each block, by node, then slot
};

}  // namespace lancet::kernels
