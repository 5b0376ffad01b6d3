#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lancet/kernels/layout/node_numbering.hpp"
#include "lancet/kernels/layout/row_pattern.hpp"

namespace lancet::runtime {

/// The aggregates of a numbering, and the pieces that cuts have severed from them. An aggregate is a range of internal
/// numbers, which a cut in place leaves as it is. Where its nodes do not hang together any more, the largest piece goes
/// on as the aggregate, and every other one is a further aggregate with a list of nodes. So none straddles a cut.
///
/// Aggregates have the numbers of the numbering, those of its room included; pieces come behind them, and keep their
/// numbers as long as they are what they are.
///
/// Not every number stands for rigid motions of its own. What has few nodes, pieces and aggregates of the room, follows
/// the larger one that it hangs on most: both move as one, like in a body that is laid out anew. The one that is
/// followed is their leader; what has no node has none.
class Aggregates {
  public:
    struct Piece {
        std::int32_t aggregate = -1;  ///< in whose range its nodes are
        std::vector<std::int32_t> nodes{};
        friend bool operator==(const Piece&, const Piece&) = default;
    };

    explicit Aggregates(const kernels::NodeNumbering& numbering);

    /// How many edges two numbers have in common.
    struct Link {
        std::int32_t first = 0;
        std::int32_t second = 0;
        int edges = 0;
    };
    /// Chooses leaders anew, where `links` are all there are between the present numbers.
    void choose_leaders(std::span<const Link> links);
    /// [number] itself, or what it follows, or -1 where it has no node.
    std::span<const std::int32_t> leader() const noexcept { return leader_; }
    bool is_leader(std::int32_t number) const { return leader_[static_cast<std::size_t>(number)] == number; }

    /// Finds the pieces of some blocks anew, from the edges that have elements. Returns the blocks in which aggregates
    /// are not what they were, ascending. `pattern` must be of content upper_edges.
    std::vector<int> change(const kernels::RowPattern& pattern, std::span<const int> blocks);

    /// All numbers, also of what has no node.
    int count() const noexcept { return first_piece_ + static_cast<int>(pieces_.size()); }
    /// [node], -1 at fixed nodes.
    const std::vector<std::int32_t>& of_node() const noexcept { return of_node_; }
    /// The block of an aggregate or a piece.
    int block_of(std::int32_t aggregate) const;

    /// Calls visit(aggregate) for those of a block, its pieces included.
    template <class Visit>
    void for_each_of_block(int block, const Visit& visit) const {
        for (std::int32_t a = numbering_->block_aggregate_begin[block];
             a < numbering_->block_aggregate_begin[block + 1]; ++a) {
            visit(a);
        }
        for (const std::int32_t piece : pieces_of_block_[static_cast<std::size_t>(block)]) visit(piece);
    }
    /// Calls visit(number, piece) for the pieces of a block.
    template <class Visit>
    void for_each_piece(int block, const Visit& visit) const {
        for (const std::int32_t number : pieces_of_block_[static_cast<std::size_t>(block)]) {
            visit(number, pieces_[static_cast<std::size_t>(number - first_piece_)]);
        }
    }
    /// Calls visit(node) for the nodes of an aggregate or a piece, in ascending order.
    template <class Visit>
    void for_each_node(std::int32_t aggregate, const Visit& visit) const {
        if (aggregate >= first_piece_) {
            for (const std::int32_t node : pieces_[static_cast<std::size_t>(aggregate - first_piece_)].nodes) {
                if (numbering_->user_of_internal[node] >= 0) visit(node);
            }
            return;
        }
        for (std::int32_t node = numbering_->aggregate_begin[aggregate];
             node < numbering_->aggregate_begin[aggregate + 1]; ++node) {
            if (numbering_->user_of_internal[node] >= 0 && of_node_[node] == aggregate) visit(node);
        }
    }

    /// The same for all nodes that move with a leader: its own, and those of what follows it.
    template <class Visit>
    void for_each_node_led(std::int32_t leader, const Visit& visit) const {
        for_each_node(leader, visit);
        for (const std::int32_t follower : followers_[static_cast<std::size_t>(leader)]) for_each_node(follower, visit);
    }

    /// Calls visit(number, leader) for all that follow, ascending by leader.
    template <class Visit>
    void for_each_follower(const Visit& visit) const {
        for (std::size_t leader = 0; leader < followers_.size(); ++leader) {
            for (const std::int32_t follower : followers_[leader]) visit(follower, static_cast<std::int32_t>(leader));
        }
    }

    std::size_t bytes() const noexcept;

  private:
    std::vector<Piece> severed(const kernels::RowPattern& pattern, int block) const;
    bool is_known(int block, const std::vector<Piece>& found) const;
    void replace(int block, std::vector<Piece> found);
    /// The aggregate of the numbering in whose range a node is; -1 at fixed nodes.
    std::int32_t range_of(std::int32_t node) const {
        const std::int32_t a = of_node_[node];
        return a < first_piece_ ? a : pieces_[static_cast<std::size_t>(a - first_piece_)].aggregate;
    }

    int nodes_of(std::int32_t number) const;
    void let_follow(std::span<const Link> links, std::span<const int> nodes);

    const kernels::NodeNumbering* numbering_;
    std::int32_t first_piece_;
    std::int32_t first_of_room_;  ///< aggregate
    int few_;                     ///< nodes, half of what aggregates have on average: what has less follows
    std::vector<std::int32_t> of_node_;
    std::vector<Piece> pieces_;                               ///< without nodes where the number is free
    std::vector<std::vector<std::int32_t>> pieces_of_block_;  ///< their numbers
    std::vector<std::int32_t> free_numbers_;
    std::vector<std::int32_t> leader_;                  ///< [number]
    std::vector<std::vector<std::int32_t>> followers_;  ///< [number] what follows it, ascending
};

}  // namespace lancet::runtime
