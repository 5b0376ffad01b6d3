#include "lancet/runtime/solve/aggregates.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "lancet/kernels/layout/aligned_vector.hpp"

namespace lancet::runtime {

Aggregates::Aggregates(const kernels::NodeNumbering& numbering)
    : numbering_(&numbering),
      first_piece_(numbering.aggregates()),
      of_node_(static_cast<std::size_t>(numbering.node_count), -1),
      pieces_of_block_(static_cast<std::size_t>(numbering.blocks())) {
    for (std::int32_t a = 0; a < first_piece_; ++a) {
        std::fill(of_node_.begin() + numbering.aggregate_begin[a], of_node_.begin() + numbering.aggregate_begin[a + 1],
                  a);
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
                if (pattern.incidence_begin[entry] == pattern.incidence_begin[entry + 1]) continue;
                const std::int32_t* elements =
                    pattern.incidence.data() +
                    static_cast<std::ptrdiff_t>(pattern.incidence_begin[entry]) * 2 * pattern.width;
                for (int lane = 0; lane < pattern.width; ++lane) {
                    if (elements[lane] == pattern.nothing()) continue;
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
    return bytes;
}

}  // namespace lancet::runtime
