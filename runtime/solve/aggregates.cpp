#include "lancet/runtime/solve/aggregates.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <numeric>
#include <utility>

#include "lancet/kernels/layout/aligned_vector.hpp"

namespace lancet::runtime {

Aggregates::Aggregates(const kernels::NodeNumbering& numbering)
    : numbering_(&numbering),
      first_piece_(numbering.aggregates()),
      first_of_room_(numbering.block_aggregate_begin[static_cast<std::size_t>(numbering.first_blocks())]),
      few_(first_of_room_ > 0 ? numbering.spare_begin / (2 * first_of_room_) : 0),
      of_node_(static_cast<std::size_t>(numbering.node_count), -1),
      pieces_of_block_(static_cast<std::size_t>(numbering.blocks())) {
    for (std::int32_t a = 0; a < first_piece_; ++a) {
        std::fill(of_node_.begin() + numbering.aggregate_begin[a], of_node_.begin() + numbering.aggregate_begin[a + 1],
                  a);
    }
}

int Aggregates::nodes_of(std::int32_t number) const {
    int nodes = 0;
    for_each_node(number, [&](std::int32_t) { ++nodes; });
    return nodes;
}

void Aggregates::choose_leaders(std::span<const Link> links) {
    const auto numbers = static_cast<std::size_t>(count());
    std::vector<int> nodes(numbers);
    leader_.assign(numbers, -1);
    // The others always have nodes, and lead.
    std::iota(leader_.begin(), leader_.begin() + first_of_room_, 0);
    for (std::int32_t a = first_of_room_; a < count(); ++a) {
        nodes[a] = nodes_of(a);
        if (nodes[a] > 0 && nodes[a] >= few_) leader_[a] = a;
    }
    let_follow(links, nodes);
    followers_.assign(numbers, {});
    for (std::int32_t a = 0; a < count(); ++a) {
        if (leader_[a] >= 0 && leader_[a] != a) followers_[leader_[a]].push_back(a);
    }
}

/// Finds leaders for what has nodes but none yet, the largest first.
void Aggregates::let_follow(std::span<const Link> links, std::span<const int> nodes) {
    std::vector<std::vector<std::pair<std::int32_t, int>>> neighbours(nodes.size());
    for (const Link& link : links) {
        if (link.first == link.second) continue;
        neighbours[link.first].emplace_back(link.second, link.edges);
        neighbours[link.second].emplace_back(link.first, link.edges);
    }
    std::vector<std::int32_t> left;
    for (std::int32_t a = first_of_room_; a < count(); ++a) {
        if (nodes[a] > 0 && leader_[a] < 0) left.push_back(a);
    }
    std::ranges::stable_sort(left, std::ranges::greater(), [&](std::int32_t a) { return nodes[a]; });
    const auto finds_leader = [&](std::int32_t a) {
        std::map<std::int32_t, int> edges;  // that it has in common with each leader and its followers
        for (const auto& [other, common] : neighbours[a]) {
            if (leader_[other] >= 0) edges[leader_[other]] += common;
        }
        const auto most = std::ranges::max_element(edges, {}, [](const auto& entry) { return entry.second; });
        if (most != edges.end() && most->second > 0) leader_[a] = most->first;
        return leader_[a] >= 0;
    };
    while (!left.empty()) {
        if (std::erase_if(left, finds_leader) > 0) continue;
        // These hang on nothing but each other.
        leader_[left.front()] = left.front();
        left.erase(left.begin());
    }
}

int Aggregates::block_of(std::int32_t aggregate) const {
    if (aggregate >= first_piece_) aggregate = pieces_[static_cast<std::size_t>(aggregate - first_piece_)].aggregate;
    const auto& begin = numbering_->block_aggregate_begin;
    return static_cast<int>(std::upper_bound(begin.begin(), begin.end(), aggregate) - begin.begin()) - 1;
}

std::vector<int> Aggregates::change(const kernels::RowPattern& pattern, std::span<const int> blocks) {
    std::vector<int> changed;
    std::vector<std::vector<Piece>> pieces;
    for (const int block : blocks) {
        std::vector<Piece> found = severed(pattern, block);
        if (is_known(block, found)) continue;
        changed.push_back(block);
        pieces.push_back(std::move(found));
    }
    for (std::size_t k = 0; k < changed.size(); ++k) replace(changed[k], std::move(pieces[k]));
    return changed;
}

/// The pieces of a block's aggregates, but for the largest of each, ordered by their first nodes.
std::vector<Aggregates::Piece> Aggregates::severed(const kernels::RowPattern& pattern, int block) const {
    const std::int32_t first = numbering_->block_begin[block], last = numbering_->block_begin[block + 1];
    std::vector<std::int32_t> group(static_cast<std::size_t>(last - first));
    std::iota(group.begin(), group.end(), 0);
    const auto find = [&](std::int32_t node) {
        while (group[node] != node) node = group[node] = group[group[node]];
        return node;
    };
    const auto is_own = [&](std::int32_t node) { return first <= node && node < last; };
    const auto unite_edges_of = [&](int rows) {
        for (std::int32_t chunk = pattern.block_chunk_begin[rows]; chunk < pattern.block_chunk_begin[rows + 1];
             ++chunk) {
            for (std::int32_t entry = pattern.chunk_entry_begin[chunk]; entry < pattern.chunk_entry_begin[chunk + 1];
                 ++entry) {
                for (int lane = 0; lane < pattern.width; ++lane) {
                    if (!pattern.has_elements(entry, lane)) continue;
                    const std::int32_t a = pattern.row[chunk * pattern.width + lane] / 4,
                                       b = pattern.column[entry * pattern.width + lane] / 4;
                    if (!is_own(a) || !is_own(b) || range_of(a) != range_of(b)) continue;
                    const std::int32_t of_a = find(a - first), of_b = find(b - first);
                    group[std::max(of_a, of_b)] = std::min(of_a, of_b);
                }
            }
        }
    };
    unite_edges_of(block);
    // The room also has edges of nodes of other blocks.
    if (numbering_->has_room() && block != numbering_->first_blocks()) unite_edges_of(numbering_->first_blocks());

    std::vector<std::vector<std::int32_t>> nodes(group.size());  // of each group, by its first node
    for (std::int32_t node = first; node < last; ++node) {
        if (numbering_->user_of_internal[node] >= 0) nodes[find(node - first)].push_back(node);
    }
    std::vector<Piece> pieces;
    for (std::int32_t a = numbering_->block_aggregate_begin[block]; a < numbering_->block_aggregate_begin[block + 1];
         ++a) {
        const auto begin = nodes.begin() + (numbering_->aggregate_begin[a] - first),
                   end = nodes.begin() + (numbering_->aggregate_begin[a + 1] - first);
        const auto largest =
            std::max_element(begin, end, [](const auto& p, const auto& q) { return p.size() < q.size(); });
        for (auto piece = begin; piece != end; ++piece) {
            if (piece != largest && !piece->empty()) pieces.push_back({a, std::move(*piece)});
        }
    }
    return pieces;
}

bool Aggregates::is_known(int block, const std::vector<Piece>& found) const {
    const auto piece = [&](std::int32_t number) -> const Piece& {
        return pieces_[static_cast<std::size_t>(number - first_piece_)];
    };
    return std::ranges::equal(found, pieces_of_block_[static_cast<std::size_t>(block)], {}, {}, piece);
}

void Aggregates::replace(int block, std::vector<Piece> found) {
    std::vector<std::int32_t>& numbers = pieces_of_block_[static_cast<std::size_t>(block)];
    for (const std::int32_t number : numbers) {
        Piece& piece = pieces_[static_cast<std::size_t>(number - first_piece_)];
        for (const std::int32_t node : piece.nodes) of_node_[node] = piece.aggregate;
        piece.nodes.clear();
        free_numbers_.push_back(number);
    }
    numbers.clear();
    for (Piece& piece : found) {
        std::int32_t number = count();
        if (free_numbers_.empty()) {
            pieces_.emplace_back();
        } else {
            number = free_numbers_.back();
            free_numbers_.pop_back();
        }
        for (const std::int32_t node : piece.nodes) of_node_[node] = number;
        pieces_[static_cast<std::size_t>(number - first_piece_)] = std::move(piece);
        numbers.push_back(number);
    }
}

std::size_t Aggregates::bytes() const noexcept {
    std::size_t bytes = kernels::heap_bytes(of_node_) + kernels::heap_bytes(pieces_);
    for (const Piece& piece : pieces_) bytes += kernels::heap_bytes(piece.nodes);
    for (const auto& numbers : pieces_of_block_) bytes += kernels::heap_bytes(numbers);
    bytes += kernels::heap_bytes(leader_) + kernels::heap_bytes(followers_);
    for (const auto& numbers : followers_) bytes += kernels::heap_bytes(numbers);
    return bytes;
}

}  // namespace lancet::runtime
